"""The theme of the material controls: what they draw is in the colours of the tokens, in both themes."""

import pytest

from workbench.state import THEMES, tokens
from workbench.views.theme import control_theme


@pytest.mark.parametrize("theme", THEMES)
def test_arrows_of_pickers_have_the_ink_of_texts(theme):
    parts, ink = control_theme()[theme]["components"], tokens(theme).colours["ink2"]
    picker = parts["MuiAutocomplete"]["styleOverrides"]
    shown = [picker["popupIndicator"], picker["clearIndicator"], parts["MuiSelect"]["styleOverrides"]["icon"]]
    assert [style["color"] for style in shown] == [ink] * 3
