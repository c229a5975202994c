"""Frozen types, errors and small tools that everything else is made of; numpy only."""

from corpus_tools.core.arrays import BoolArray, FloatArray, IntArray, frozen
from corpus_tools.core.capture import FLAGGED, SPEECH_REGIONS, Audio, Capture, FrameFlag, region_columns
from corpus_tools.core.errors import (
    ConfigError,
    CorpusError,
    EngineError,
    InputError,
    LabelError,
    MeshError,
    MissingExtraError,
    MotionError,
    NoUnitError,
    OutputError,
    SynthesisError,
    WorkbenchError,
)
from corpus_tools.core.files import atomic_file, atomic_folder, check_writable
from corpus_tools.core.fragment import Fragment, UnitInventory
from corpus_tools.core.history import History, Step, step
from corpus_tools.core.labels import Interval, Labels, Point, PointTier, Tier
from corpus_tools.core.mesh import Mesh
from corpus_tools.core.registry import Registry
from corpus_tools.core.selection import Candidate, ChosenUnit, Costs, Selection, UnitRef
from corpus_tools.core.trajectory import Join, Trajectory
from corpus_tools.core.utterance import Recording, Utterance, speech_span_s
from corpus_tools.core.words import counted

__all__ = [
    "FLAGGED",
    "SPEECH_REGIONS",
    "Audio",
    "BoolArray",
    "Candidate",
    "Capture",
    "ChosenUnit",
    "ConfigError",
    "CorpusError",
    "Costs",
    "EngineError",
    "FloatArray",
    "Fragment",
    "FrameFlag",
    "History",
    "InputError",
    "IntArray",
    "Interval",
    "Join",
    "LabelError",
    "Labels",
    "Mesh",
    "MeshError",
    "MissingExtraError",
    "MotionError",
    "NoUnitError",
    "OutputError",
    "Point",
    "PointTier",
    "Recording",
    "Registry",
    "Selection",
    "Step",
    "SynthesisError",
    "Tier",
    "Trajectory",
    "UnitInventory",
    "UnitRef",
    "Utterance",
    "WorkbenchError",
    "atomic_file",
    "atomic_folder",
    "check_writable",
    "counted",
    "frozen",
    "region_columns",
    "speech_span_s",
    "step",
]
