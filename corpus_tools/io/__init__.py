"""Files in and out: one format, one file; corpora as folders that are used as they are."""

from corpus_tools.io.corpus import (
    RecordingFiles,
    check_word_tier,
    find_recordings,
    init_corpus,
    load_audio,
    load_capture,
    load_labels,
)
from corpus_tools.io.csv_writing import write_csv, write_csv_long
from corpus_tools.io.description import (
    CORPUS_FILE,
    CorpusDescription,
    description_from_dict,
    parsed_axes,
    read_description,
    write_description,
)
from corpus_tools.io.ema_mat import read_ema, read_ema_labels, read_ema_sound
from corpus_tools.io.formats import (
    AUDIO_READERS,
    LABEL_READERS,
    MOTION_READERS,
    MOTION_WRITERS,
    read_audio,
    read_labels,
    read_markers,
)
from corpus_tools.io.hashes import content_hash, file_hash
from corpus_tools.io.markers_c3d import read_c3d, write_c3d
from corpus_tools.io.markers_csv import read_csv
from corpus_tools.io.markers_npz import read_markers_npz, write_markers_npz
from corpus_tools.io.markers_trc import read_trc, write_trc
from corpus_tools.io.motion_parts import reading_notes
from corpus_tools.io.textgrid import read_textgrid, write_textgrid
from corpus_tools.io.wav import read_sound, write_wav
from corpus_tools.io.writing import write_motion_file

__all__ = [
    "AUDIO_READERS",
    "CORPUS_FILE",
    "LABEL_READERS",
    "MOTION_READERS",
    "MOTION_WRITERS",
    "CorpusDescription",
    "RecordingFiles",
    "check_word_tier",
    "content_hash",
    "description_from_dict",
    "file_hash",
    "find_recordings",
    "init_corpus",
    "load_audio",
    "load_capture",
    "load_labels",
    "parsed_axes",
    "read_audio",
    "read_c3d",
    "read_csv",
    "read_description",
    "read_ema",
    "read_ema_labels",
    "read_ema_sound",
    "read_labels",
    "read_markers",
    "read_markers_npz",
    "read_sound",
    "read_textgrid",
    "read_trc",
    "reading_notes",
    "write_c3d",
    "write_csv",
    "write_csv_long",
    "write_description",
    "write_markers_npz",
    "write_motion_file",
    "write_textgrid",
    "write_trc",
    "write_wav",
]
