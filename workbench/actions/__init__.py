"""What a person sets off: long jobs, opening corpora, export; without drawing anything."""

from workbench.actions.corpora import CorpusCache, inside_root
from workbench.actions.desk import Desk
from workbench.actions.export import (
    export_config,
    export_stem,
    export_target,
    exports_beside,
    replay_command,
    suggested_path,
)
from workbench.actions.jobs import Cancelled, Gate, Job, LatestJob
from workbench.actions.picks import (
    ban_unit,
    heard,
    is_tried,
    options_shown,
    swap_to,
    swap_unit,
    toggle_pin,
    unban,
)

__all__ = [
    "Cancelled",
    "CorpusCache",
    "Desk",
    "Gate",
    "Job",
    "LatestJob",
    "ban_unit",
    "export_config",
    "export_stem",
    "export_target",
    "exports_beside",
    "heard",
    "inside_root",
    "is_tried",
    "options_shown",
    "replay_command",
    "suggested_path",
    "swap_to",
    "swap_unit",
    "toggle_pin",
    "unban",
]
