"""What a person works on, without Panel: session, stages, tokens, keys, and data for the views."""

from workbench.state.keys import KeyBinding, key_label, key_table
from workbench.state.lane_data import (
    FragmentDetails,
    aperture_curves,
    fragment_details,
    joins_data,
    phone_rows,
    score,
    weighting_samples,
)
from workbench.state.session import SETTINGS, STATUSES, Session, default_config
from workbench.state.stages import Request, Result, Stages
from workbench.state.tokens import THEMES, Tokens, css_variables, read_tokens, source_slots, tokens

__all__ = [
    "SETTINGS",
    "STATUSES",
    "THEMES",
    "FragmentDetails",
    "KeyBinding",
    "Request",
    "Result",
    "Session",
    "Stages",
    "Tokens",
    "aperture_curves",
    "css_variables",
    "default_config",
    "fragment_details",
    "joins_data",
    "key_label",
    "key_table",
    "phone_rows",
    "read_tokens",
    "score",
    "source_slots",
    "tokens",
    "weighting_samples",
]
