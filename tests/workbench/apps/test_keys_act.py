"""Every key of the table acts: in the page itself, or by a command of the server."""

import re

from workbench.actions import CorpusCache
from workbench.apps.blend import BlendPage
from workbench.state import key_table
from workbench.views.settings_panel import PRESETS
from workbench.views.theme import FRONTEND

IN_SHELL = {"help", "curve", "overlap"}


def in_lane():
    """Return the actions that the lane takes up itself."""
    text = (FRONTEND / "lane.js").read_text(encoding="utf-8")
    body = re.search(r"const act = {(.*?)\n  };", text, re.DOTALL)
    return set(re.findall(r"^    (\w+): \(", body[1], re.MULTILINE))


def test_every_key_of_the_table_acts_and_no_action_lacks_a_key(tmp_path):
    page = BlendPage(CorpusCache(), lambda progress: tmp_path, tmp_path, lambda action: action())
    try:
        assert {row.id for row in key_table("blend")} == in_lane() | IN_SHELL | set(page.commands)
        page._key("theme", 0)
        assert page.session.theme == "dark"
        for index, name in enumerate(PRESETS.values()):
            page._key("curve", index)
            assert page.session.weighting == name
        curve = next(row for row in key_table("blend") if row.id == "curve")
        assert len(curve.keys) == len(PRESETS)
    finally:
        page.close()
