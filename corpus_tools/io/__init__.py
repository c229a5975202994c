"""Files in and out: one format, one file; corpora as folders that are used as they are."""

from corpus_tools.io.corpus import (
    RecordingFiles,
    find_recordings,
    init_corpus,
    load_audio,
    load_capture,
    load_labels,
)
from corpus_tools.io.description import (
    CORPUS_FILE,
    CorpusDescription,
    description_from_dict,
    read_description,
    write_description,
)
from corpus_tools.io.formats import (
    AUDIO_READERS,
    LABEL_READERS,
    MOTION_READERS,
    read_audio,
    read_labels,
    read_markers,
)
from corpus_tools.io.hashes import content_hash, file_hash
from corpus_tools.io.markers_npz import read_markers_npz, write_markers_npz
from corpus_tools.io.textgrid import read_textgrid, write_textgrid
from corpus_tools.io.wav import read_sound, write_wav

__all__ = [
    "AUDIO_READERS",
    "CORPUS_FILE",
    "LABEL_READERS",
    "MOTION_READERS",
    "CorpusDescription",
    "RecordingFiles",
    "content_hash",
    "description_from_dict",
    "file_hash",
    "find_recordings",
    "init_corpus",
    "load_audio",
    "load_capture",
    "load_labels",
    "read_audio",
    "read_description",
    "read_labels",
    "read_markers",
    "read_markers_npz",
    "read_sound",
    "read_textgrid",
    "write_description",
    "write_markers_npz",
    "write_textgrid",
    "write_wav",
]
