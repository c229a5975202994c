"""Colours by numbers: a value a vertex, a range, a table of colours, and what the legend says."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pyvista as pv

from corpus_tools.core import MeshError

__all__ = ["address", "mapped_scalars", "scalar_colours"]


def scalar_colours(
    values: npt.ArrayLike,
    *,
    cmap: Any = "viridis",
    clim: tuple[float, float] | None = None,
    title: str = "",
    legend: bool = True,
    log: bool = False,
    n_colours: int = 256,
    below: Any = None,
    above: Any = None,
    nan: Any = "darkgray",
) -> dict[str, Any]:
    """Return scalars as plain data for :func:`workbench.views.scene_actors.surface_actor`.

    Parameters
    ----------
    values : (n,)
        One a point or a cell; NaN has a colour of its own.
    cmap : anything pyvista takes for a colour map
    clim : (low, high), optional
        Range of the colours; that of the finite values when not given.
    title : str
        What the numbers are, with their unit: "Speed, mm/s".
    legend : bool
        Show a bar of the colours in the view.
    log : bool
        Colours follow the logarithm.
    below, above, nan : colour, optional
        Of values outside the range (the end of the range when not given), and of none.

    Raises
    ------
    MeshError
        `values` is not a row of numbers, or a logarithmic range is not above zero.
    """
    table = pv.LookupTable(cmap, n_values=n_colours, nan_color=nan)
    rgba = np.asarray(table.values, np.uint8)
    return _plain(values, rgba, clim, title, legend, log, below, above, nan)


def _plain(
    values: npt.ArrayLike,
    rgba: npt.NDArray[np.uint8],
    clim: tuple[float, float] | None,
    title: str,
    legend: bool,
    log: bool,
    below: Any,
    above: Any,
    nan: Any,
) -> dict[str, Any]:
    numbers = np.asarray(values, float)
    if numbers.ndim != 1:
        raise MeshError(f"Scalars must be one row of numbers; they have shape {numbers.shape}.")
    low, high = _range(numbers) if clim is None else (float(clim[0]), float(clim[1]))
    if log:
        if low <= 0:
            raise MeshError(f"A logarithmic range of colours must lie above 0; it begins at {low:g}.")
        with np.errstate(divide="ignore", invalid="ignore"):
            numbers = np.log10(numbers)
        low, high = float(np.log10(low)), float(np.log10(high))
    ends = [rgba[0] if below is None else _rgba(below), rgba[-1] if above is None else _rgba(above)]
    table = np.vstack([ends[0], rgba, ends[1], _rgba(nan)]).astype(np.uint8)
    return {
        "values": numbers.astype(np.float32).tobytes(),
        "range": [low, high],
        "table": table.tobytes(),
        "title": str(title),
        "legend": bool(legend),
        "log": bool(log),
    }


def _range(numbers: npt.NDArray[np.float64]) -> tuple[float, float]:
    finite = numbers[np.isfinite(numbers)]
    return (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)


def _rgba(colour: Any) -> list[int]:
    return list(pv.Color(colour).int_rgba)


def address(thing: Any) -> str:
    """Return what tells two VTK objects apart; their Python wrappers come and go."""
    return str(thing.GetAddressAsString(""))


def mapped_scalars(mapper: Any, titles: dict[str, str]) -> dict[str, Any] | None:
    """Return the scalars that a pyvista mapper colours by; None where it does in no way the browser can.

    Parameters
    ----------
    mapper : pv.DataSetMapper
    titles : mapping of address of a lookup table -> title
        Of the scalar bars of its scene.
    """
    table = mapper.lookup_table
    mode = str(mapper.scalar_map_mode)
    if (
        not isinstance(table, pv.LookupTable)
        or mapper.color_mode == "direct"
        or mode not in ("point", "cell")
    ):
        return None
    data = mapper.dataset.point_data if mode == "point" else mapper.dataset.cell_data
    values = np.asarray(data[mapper.array_name]) if mapper.array_name in data else np.zeros((0, 0))
    if values.ndim != 1 or values.dtype.kind not in "fiub":
        return None
    low, high = mapper.scalar_range
    return _plain(
        values,
        np.asarray(table.values, np.uint8),
        (low, high),
        titles.get(address(table), str(mapper.array_name)),
        address(table) in titles,
        bool(table.log_scale),
        table.below_range_color,
        table.above_range_color,
        table.nan_color,
    )
