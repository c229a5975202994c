"""What a person sets off: long jobs, opening corpora, export; without drawing anything."""

from workbench.actions.corpora import CorpusCache, inside_root
from workbench.actions.desk import Desk
from workbench.actions.export import (
    export_config,
    export_stem,
    export_target,
    exports_beside,
    read_config,
    replay_command,
    spoken_of,
    suggested_path,
)
from workbench.actions.jobs import Cancelled, Gate, Job, LatestJob
from workbench.actions.journal import Journal, journal_folder
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
    "Journal",
    "LatestJob",
    "ban_unit",
    "export_config",
    "export_stem",
    "export_target",
    "exports_beside",
    "heard",
    "inside_root",
    "is_tried",
    "journal_folder",
    "options_shown",
    "read_config",
    "replay_command",
    "spoken_of",
    "suggested_path",
    "swap_to",
    "swap_unit",
    "toggle_pin",
    "unban",
]
