"""A corpus that is read and cleaned anew each time it is asked for, by what may be known then."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence

from corpus_tools.core import InputError, Recording
from corpus_tools.pipeline.reading import Progress, RawCorpus, cleaned_recordings

__all__ = ["CorpusSource"]


class CorpusSource:
    """The recordings of a corpus, cleaned as often as they are asked for.

    Recordings as captured are held while they are cleaned, not while methods are fitted: reading them again
    is a small part of a fold.

    Parameters
    ----------
    read : callable
        Reads the corpus; called at once, and again for every later cleaning.

    Attributes
    ----------
    phones : PhoneSet
    names : tuple of str
        Ids of the usable recordings.
    skipped : dict of recording id -> sentence
    description : CorpusDescription
    """

    def __init__(self, read: Callable[[], RawCorpus]) -> None:
        self._read = read
        raw = read()
        self._raw: RawCorpus | None = raw
        self.phones, self.names, self.skipped = raw.phones, raw.names, raw.skipped
        self.description = raw.description

    def cleaned(self, learn_from: Collection[str], progress: Progress) -> Sequence[Recording]:
        """Return all recordings cleaned, with a head shape and a face model of some of them only.

        Raises
        ------
        InputError
            Other recordings are usable than at the start.
        """
        raw, self._raw = self._raw or self._read(), None
        if raw.names != self.names:
            raise InputError(
                f"'{self.description.folder}': {len(raw.names)} recordings are usable and {len(self.names)} "
                "were at the start; leave the corpus as it is until the evaluation is done."
            )
        return cleaned_recordings(raw, learn_from=frozenset(learn_from), progress=progress)[0]
