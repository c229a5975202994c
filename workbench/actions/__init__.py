"""What a person sets off: long jobs, opening corpora, export; without drawing anything."""

from workbench.actions.corpora import CorpusCache, inside_root
from workbench.actions.desk import Desk
from workbench.actions.export import export_config, replay_command, suggested_path
from workbench.actions.jobs import Cancelled, Job, LatestJob

__all__ = [
    "Cancelled",
    "CorpusCache",
    "Desk",
    "Job",
    "LatestJob",
    "export_config",
    "inside_root",
    "replay_command",
    "suggested_path",
]
