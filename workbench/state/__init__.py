"""What a person works on, without Panel: session, stages, tokens, keys, and data for the views."""

from workbench.state.corpus_facts import CorpusFacts, RecordingRow, corpus_facts, recording_rows
from workbench.state.editing import EDITABLE, SETTINGS, TARGETS, default_config
from workbench.state.effects import OVERLAPS_S, Effects, compute_effects, effect_data, signal_band
from workbench.state.history import Entry, History, change_text
from workbench.state.journal import JOURNAL, resume, session_record
from workbench.state.keys import KeyBinding, key_label, key_table
from workbench.state.lane_data import (
    FragmentDetails,
    aperture_curves,
    band_data,
    fragment_details,
    joins_data,
    phone_rows,
    score,
    stand_ins,
    weighting_samples,
)
from workbench.state.picks import Option, Options, fragment_at, options_of, pin_at, with_pin, without_pin
from workbench.state.said import distance_mm, held_out_text, lane_text
from workbench.state.session import STATUSES, Session
from workbench.state.signals import SIGNALS, Signal, marker_signal, signals_of, speed_mm_s
from workbench.state.stages import Request, Result, Stages
from workbench.state.tokens import THEMES, Tokens, css_variables, read_tokens, source_slots, tokens
from workbench.state.trajectory_data import signal_data

__all__ = [
    "EDITABLE",
    "JOURNAL",
    "OVERLAPS_S",
    "SETTINGS",
    "SIGNALS",
    "STATUSES",
    "TARGETS",
    "THEMES",
    "CorpusFacts",
    "Effects",
    "Entry",
    "FragmentDetails",
    "History",
    "KeyBinding",
    "Option",
    "Options",
    "RecordingRow",
    "Request",
    "Result",
    "Session",
    "Signal",
    "Stages",
    "Tokens",
    "aperture_curves",
    "band_data",
    "change_text",
    "compute_effects",
    "corpus_facts",
    "css_variables",
    "default_config",
    "distance_mm",
    "effect_data",
    "fragment_at",
    "fragment_details",
    "held_out_text",
    "joins_data",
    "key_label",
    "key_table",
    "lane_text",
    "marker_signal",
    "options_of",
    "phone_rows",
    "pin_at",
    "read_tokens",
    "recording_rows",
    "resume",
    "score",
    "session_record",
    "signal_band",
    "signal_data",
    "signals_of",
    "source_slots",
    "speed_mm_s",
    "stand_ins",
    "tokens",
    "weighting_samples",
    "with_pin",
    "without_pin",
]
