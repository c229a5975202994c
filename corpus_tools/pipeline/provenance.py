"""Who is what: hashes of a corpus that make a result repeatable."""

from __future__ import annotations

from typing import Any

from corpus_tools.io import content_hash, find_recordings
from corpus_tools.pipeline.opened import OpenCorpus

__all__ = ["corpus_provenance"]


def corpus_provenance(corpus: OpenCorpus) -> dict[str, Any]:
    """Return name and content hashes of a corpus: the motion, labels and audio of every recording."""
    files = find_recordings(corpus.description)
    kinds = {
        "motion": [f.motion for f in files],
        "labels": [f.labels for f in files if f.labels],
        "audio": [f.audio for f in files if f.audio],
    }
    return {
        "name": corpus.description.name,
        "recordings": len(corpus.recordings),
        "skipped": len(corpus.skipped),
        **{f"{kind}_sha256": content_hash(paths) for kind, paths in kinds.items()},
    }
