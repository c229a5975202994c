"""Material controls in the look of the tokens, and two-way ties between a control and a session."""

from __future__ import annotations

from typing import Any

import panel_material_ui as pmui
import param

from workbench.views.prompt import prompt
from workbench.views.theme import control_theme

__all__ = ["Controls", "button", "preset_buttons", "select", "slider", "text_field"]

_HIDDEN_LABEL = ".MuiFormLabel-root { position: absolute; width: 1px; height: 1px; clip-path: inset(50%); }"


class Controls:
    """Makes controls of one theme and switches them together.

    Parameters
    ----------
    session : param.Parameterized
        Has a parameter `theme`, "light" or "dark".
    """

    def __init__(self, session: param.Parameterized) -> None:
        self._session = session
        self._made: list[Any] = []
        session.param.watch(self._switch, "theme")

    def _switch(self, event: Any) -> None:
        for control in self._made:
            control.dark_theme = event.new == "dark"

    def make(self, kind: Any, **values: Any) -> Any:
        """Return ``kind(**values)`` in the theme."""
        dark = self._session.theme == "dark"
        control = kind(theme_config=control_theme(), dark_theme=dark, **values)
        prompt(control, "value", "value_input")
        self._made.append(control)
        return control

    def tie(self, control: Any, name: str, parameter: str = "value", factor: float = 1.0) -> Any:
        """Tie a control's value to the session's parameter `name`, both ways; return the control.

        `factor` is the unit of the session in that of the control: 1000 where seconds are shown as ms.
        """
        session = self._session

        def shown(value: Any) -> Any:
            return value if factor == 1.0 else round(value * factor, 6)

        def to_session(event: Any) -> None:
            if event.new is not None and event.new != shown(getattr(session, name)):
                setattr(session, name, event.new if factor == 1.0 else round(event.new / factor, 9))

        def to_control(event: Any) -> None:
            if shown(event.new) != getattr(control, parameter):
                setattr(control, parameter, shown(event.new))

        setattr(control, parameter, shown(getattr(session, name)))
        control.param.watch(to_session, parameter)
        session.param.watch(to_control, name)
        return control


def slider(
    controls: Controls,
    label: str,
    name: str,
    bounds: tuple[float, float],
    factor: float = 1.0,
    **values: Any,
) -> Any:
    """Return a slider tied to the session's parameter `name`; `bounds` in the unit that is shown."""
    made = controls.make(
        pmui.FloatSlider,
        label=label,
        start=bounds[0],
        end=bounds[1],
        size="small",
        tooltips=False,
        sizing_mode="stretch_width",
        margin=(0, 4),
        **values,
    )
    return controls.tie(made, name, factor=factor)


def select(controls: Controls, label: str, name: str, options: Any, **values: Any) -> Any:
    """Return a drop-down tied to the session's parameter `name`."""
    made = controls.make(
        pmui.Select,
        label=label,
        options=options,
        size="small",
        variant="outlined",
        sizing_mode="stretch_width",
        **values,
    )
    return controls.tie(made, name)


def preset_buttons(controls: Controls, label: str, name: str, options: dict[str, str]) -> Any:
    """Return a row of buttons of which one is pressed, tied to the session's parameter `name`."""
    made = controls.make(
        pmui.RadioButtonGroup,
        label=label,
        options=options,
        size="small",
        variant="outlined",
        color="primary",
        sizing_mode="stretch_width",
        margin=0,
        sx={
            "& .MuiToggleButton-root": {
                "flex": "1 1 auto",
                "width": "auto",  # else all are as wide as each other, and the long words run over
                "minWidth": 0,
                "paddingLeft": 0.5,
                "paddingRight": 0.5,
            }
        },
        stylesheets=[_HIDDEN_LABEL],
    )
    return controls.tie(made, name)


def button(controls: Controls, label: str, primary: bool = False, **values: Any) -> Any:
    """Return a button: filled when `primary`, outlined else."""
    return controls.make(
        pmui.Button,
        label=label,
        variant="contained" if primary else "outlined",
        color="primary" if primary else "default",
        size="small",
        **values,
    )


def text_field(controls: Controls, label: str, **values: Any) -> Any:
    """Return a one-line text field."""
    return controls.make(
        pmui.TextInput, label=label, size="small", variant="outlined", sizing_mode="stretch_width", **values
    )
