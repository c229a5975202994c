"""Stages over an opened corpus, and the folder that a synthesis writes."""

from corpus_tools.pipeline.cleaning_report import cleaning_lines, cleaning_report, write_cleaning
from corpus_tools.pipeline.code import code_hash, library_versions
from corpus_tools.pipeline.head import Animation, Head, animate, prepare_head, vertex_frames
from corpus_tools.pipeline.health import check_corpus, health_lines
from corpus_tools.pipeline.opened import OpenCorpus, open_corpus
from corpus_tools.pipeline.outputs import write_motion, write_synthesis
from corpus_tools.pipeline.overrides import ban_of, banned_pins, overrides_of, parse_pin, pin_text
from corpus_tools.pipeline.provenance import corpus_provenance
from corpus_tools.pipeline.reading import (
    Progress,
    RawCorpus,
    clean_corpus,
    cleaned_recordings,
    joined_corpora,
    read_corpus,
    reference_columns,
)
from corpus_tools.pipeline.source import CorpusSource
from corpus_tools.pipeline.speaking import (
    check_speech,
    corpus_vocabulary,
    sound_problem,
    speak_for,
    speech_facts,
    speech_language,
)
from corpus_tools.pipeline.stages import (
    Synthesis,
    align_units,
    blend_units,
    compare_alignments,
    link_sound,
    select_units,
    synthesise,
)
from corpus_tools.pipeline.stale import listed_files, remove_stale
from corpus_tools.pipeline.threads import one_thread
from corpus_tools.synthesis.lips import LipModel

__all__ = [
    "Animation",
    "CorpusSource",
    "Head",
    "LipModel",
    "OpenCorpus",
    "Progress",
    "RawCorpus",
    "Synthesis",
    "align_units",
    "animate",
    "ban_of",
    "banned_pins",
    "blend_units",
    "check_corpus",
    "check_speech",
    "clean_corpus",
    "cleaned_recordings",
    "cleaning_lines",
    "cleaning_report",
    "code_hash",
    "compare_alignments",
    "corpus_provenance",
    "corpus_vocabulary",
    "health_lines",
    "joined_corpora",
    "library_versions",
    "link_sound",
    "listed_files",
    "one_thread",
    "open_corpus",
    "overrides_of",
    "parse_pin",
    "pin_text",
    "prepare_head",
    "read_corpus",
    "reference_columns",
    "remove_stale",
    "select_units",
    "sound_problem",
    "speak_for",
    "speech_facts",
    "speech_language",
    "synthesise",
    "vertex_frames",
    "write_cleaning",
    "write_motion",
    "write_synthesis",
]
