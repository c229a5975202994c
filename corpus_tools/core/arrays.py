"""Arrays inside frozen types are read-only: a step that edits its input in place cannot exist."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["BoolArray", "FloatArray", "IntArray", "frozen"]

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]


def frozen(values: npt.ArrayLike, dtype: Any = np.float64) -> npt.NDArray[Any]:
    """Return `values` as a contiguous read-only array of `dtype`.

    A read-only array that owns its data is returned as it is; anything writable is copied, so that the
    caller's array and the frozen one never share memory.
    """
    array = np.asarray(values)
    if array.dtype == np.dtype(dtype) and not array.flags.writeable and array.flags.c_contiguous:
        return array
    array = np.array(array, dtype=dtype, order="C", copy=True)
    array.flags.writeable = False
    return array
