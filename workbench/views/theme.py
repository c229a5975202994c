"""The look of every view, made from the tokens: the style sheet, the fonts, the theme of the controls."""

from __future__ import annotations

import functools
from importlib import resources
from pathlib import Path
from typing import Any

from workbench.state import THEMES, css_variables, tokens

__all__ = ["ASSETS_ROUTE", "FRONTEND", "control_theme", "fonts", "palettes", "style_sheet"]

FRONTEND = Path(str(resources.files("workbench"))) / "frontend"
"""Folder of modules, style sheet and fonts."""

ASSETS_ROUTE = "assets"
"""Where a server offers the fonts."""

_RANGES = {
    "inter-latin": "U+0000-00FF,U+0131,U+0152-0153,U+02BB-02BC,U+02C6,U+02DA,U+02DC,U+2000-206F,U+20AC,"
    "U+2122,U+2191,U+2193,U+2212,U+2215,U+FEFF,U+FFFD",
    "inter-latin-ext": "U+0100-02BA,U+02BD-02C5,U+02C7-02CC,U+02CE-02D7,U+02DD-02FF,U+1D00-1DBF,"
    "U+1E00-1E9F,U+2C60-2C7F,U+A720-A7FF",
}


@functools.cache
def style_sheet() -> str:
    """Return the style sheet, the variables of both themes first.

    The frame carries ``data-theme``; a view without a frame around it (a notebook cell) carries it itself.
    """
    parts = [f'[data-theme="{t}"] {{\n{css_variables(t)}\n}}' for t in THEMES]
    return "\n".join([*parts, (FRONTEND / "theme.css").read_text(encoding="utf-8")])


def fonts(route: str = ASSETS_ROUTE) -> list[dict[str, str]]:
    """Return family, address and character range of the shipped fonts, as served under `route`."""
    return [
        {"family": "Inter Workbench", "url": f"{route}/{name}.woff2", "range": characters}
        for name, characters in _RANGES.items()
    ]


def palettes() -> dict[str, Any]:
    """Return the colours that canvases draw with, of both themes."""
    return {t: tokens(t).palette() for t in THEMES}


def _scheme(theme: str) -> dict[str, Any]:
    t = tokens(theme)
    c = t.colours
    size, _, _ = t.type_roles["text"]
    return {
        "palette": {
            "primary": {"main": c["acc"], "contrastText": c["acc_ink"]},
            "error": {"main": c["err"]},
            "background": {"default": c["bg"], "paper": c["panel"]},
            "text": {"primary": c["ink"], "secondary": c["ink2"]},
            "divider": c["line"],
        },
        "shape": {"borderRadius": t.sizes["radius"]},
        "typography": {"fontFamily": t.family, "fontSize": size, "htmlFontSize": 14},
        "components": _components(c, t.sizes, size),
    }


def _components(c: Any, sizes: Any, size: int) -> dict[str, Any]:
    flat = {"boxShadow": "none", "&:hover": {"boxShadow": "none"}}
    focus = {"&.Mui-focusVisible": {"outline": f"2px solid {c['acc']}", "outlineOffset": "1px"}}
    text = {"fontSize": f"{size}px", "lineHeight": "16px"}
    place = {"transform": "translate(10px, 6px) scale(1)"}  # of a field as low as these
    inside = {"&.MuiInputLabel-outlined:not(.MuiInputLabel-shrink)": place}
    outline = {"& .MuiOutlinedInput-notchedOutline": {"borderColor": c["line"]}}
    return {
        "MuiButtonBase": {"defaultProps": {"disableRipple": True}, "styleOverrides": {"root": focus}},
        "MuiButton": {
            "defaultProps": {"disableElevation": True, "size": "small"},
            "styleOverrides": {
                "root": {
                    **text,
                    **flat,
                    "textTransform": "none",
                    "fontWeight": 500,
                    "minWidth": 0,
                    "minHeight": f"{sizes['button']}px",
                    "padding": "2px 10px",
                    "&.MuiButton-outlined": {
                        "color": c["ink"],
                        "borderColor": c["line"],
                        "backgroundColor": c["panel"],
                    },
                    "&.MuiButton-outlined:hover": {"backgroundColor": c["sunk"]},
                    "&.MuiButton-outlined.Mui-disabled": {"color": c["ink3"], "opacity": 0.55},
                }
            },
        },
        "MuiToggleButton": {
            "styleOverrides": {
                "root": {
                    **text,
                    "textTransform": "none",
                    "fontWeight": 500,
                    "padding": "2px 6px",
                    "minHeight": f"{sizes['button_small']}px",
                    "borderColor": c["line"],
                    "color": c["ink"],
                    "whiteSpace": "nowrap",
                    "&.Mui-selected": {"backgroundColor": c["acc_ground"], "color": c["acc"]},
                    "&.Mui-selected:hover": {"backgroundColor": c["acc_ground"]},
                }
            }
        },
        "MuiPaper": {
            "defaultProps": {"elevation": 0},
            "styleOverrides": {"root": {"border": f"1px solid {c['line']}", "backgroundImage": "none"}},
        },
        "MuiFormLabel": {"styleOverrides": {"root": {**text, "color": c["ink2"]}}},
        "MuiInputLabel": {"styleOverrides": {"root": {**text, "color": c["ink2"], **inside}}},
        "MuiInputBase": {"styleOverrides": {"root": {**text}, "input": {"height": "16px"}}},
        "MuiOutlinedInput": {"styleOverrides": {"root": outline, "input": {"padding": "6px 8px"}}},
        "MuiMenuItem": {"styleOverrides": {"root": {**text, "minHeight": "24px", "padding": "2px 10px"}}},
        "MuiAutocomplete": {
            "styleOverrides": {
                "option": {**text},
                "inputRoot": {"padding": "0 8px"},
                "popupIndicator": {"color": c["ink2"]},
                "clearIndicator": {"color": c["ink2"]},
            }
        },
        "MuiSelect": {"styleOverrides": {"icon": {"color": c["ink2"]}}},
        "MuiTooltip": {"styleOverrides": {"tooltip": {"whiteSpace": "nowrap", "maxWidth": "none"}}},
        "MuiSlider": {
            "styleOverrides": {
                "root": {"padding": "9px 0", "height": "3px"},
                "track": {"transition": "none"},
                "thumb": {
                    "transition": "none",
                    "width": "14px",
                    "height": "14px",
                    "backgroundColor": c["panel"],
                    "border": f"2px solid {c['acc']}",
                    "boxShadow": "none",
                    "&:hover, &.Mui-active": {"boxShadow": "none"},
                    "&.Mui-focusVisible": {"boxShadow": "none", "outline": f"2px solid {c['acc']}"},
                    "&::before": {"boxShadow": "none"},
                },
                "rail": {"backgroundColor": c["line"], "opacity": 1},
            }
        },
    }


@functools.cache
def control_theme() -> dict[str, Any]:
    """Return the theme of the material controls: dense, no elevation, no ripple, colours of the tokens."""
    return {theme: _scheme(theme) for theme in THEMES}
