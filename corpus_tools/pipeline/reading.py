"""The recordings of a corpus as they are on disk, and cleaned: what comes before anything is indexed."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path

from corpus_tools.cleaning import CleanedCorpus, clean_captures
from corpus_tools.config import Config, ConfigBase
from corpus_tools.core import (
    Capture,
    CorpusError,
    Interval,
    Labels,
    Recording,
    Tier,
    Utterance,
    WorkbenchError,
)
from corpus_tools.io import (
    CorpusDescription,
    RecordingFiles,
    check_word_tier,
    find_recordings,
    load_capture,
    load_labels,
    read_description,
)
from corpus_tools.pipeline.kept import keep, kept_name, read_kept
from corpus_tools.pipeline.usable import (
    chosen_markers,
    in_order_of,
    motion_problem,
    seen_markers,
    usual_markers,
)
from corpus_tools.speech import PhoneSet, phone_set, recorded_utterance

__all__ = [
    "Progress",
    "RawCorpus",
    "clean_corpus",
    "cleaned_recordings",
    "face_only",
    "joined_corpora",
    "read_corpus",
    "reference_columns",
    "silent",
]

Progress = Callable[[float, str], None]


def silent(fraction: float, what: str) -> None:
    """Show nothing: the progress callback for when nobody waits."""


@dataclass(frozen=True, slots=True, eq=False)
class RawCorpus:
    """The usable recordings of a corpus as captured: head motion, noise and gaps are still in them.

    Attributes
    ----------
    description : CorpusDescription
    phones : PhoneSet
    captures : tuple of Capture
        The same markers in all.
    utterances : tuple of Utterance
        One per capture.
    skipped : dict of recording id -> sentence
    """

    description: CorpusDescription
    phones: PhoneSet
    captures: tuple[Capture, ...]
    utterances: tuple[Utterance, ...]
    skipped: dict[str, str]

    @property
    def names(self) -> tuple[str, ...]:
        """Ids of the usable recordings."""
        return tuple(u.name for u in self.utterances)


def reference_columns(description: CorpusDescription, capture: Capture) -> list[int]:
    """Return the columns of the rigid markers named by ``reference_markers`` (globs, comma separated)."""
    patterns = [p.strip() for p in description.reference_markers.split(",") if p.strip()]
    columns = [i for i, n in enumerate(capture.names) if any(fnmatchcase(n, p) for p in patterns)]
    if len(columns) < 3:
        raise CorpusError(
            f"'reference_markers = \"{description.reference_markers}\"' in "
            f"'{description.folder / 'corpus.toml'}' matches {len(columns)} of the markers "
            f"{', '.join(capture.names[:6])}, ...: at least 3 rigid markers are needed to remove head motion."
        )
    return columns


def face_only(capture: Capture) -> Capture:
    """Return a capture without the markers of region "head" (jig or forehead: rigid, nothing to animate)."""
    return chosen_markers(capture, [i for i, region in enumerate(capture.regions) if region != "head"])


def _load(
    description: CorpusDescription,
    files: Sequence[RecordingFiles],
    phones: PhoneSet,
    progress: Progress,
    keep_sound: bool,
    unlabelled: bool,
) -> tuple[list[tuple[Capture, Utterance]], dict[str, str]]:
    loaded, skipped, tiers = [], {}, []
    for index, item in enumerate(files):
        progress(index / len(files), f"reading {item.id}")
        try:
            capture = load_capture(description, item)
            if unlabelled and item.labels is None:
                utterance = _nothing_said(item.id, capture, phones)
            else:
                tiers.append(load_labels(description, item))
                utterance = _said(description, item.id, tiers[-1], capture, phones)
        except WorkbenchError as error:
            skipped[item.id] = str(error)
            continue
        if not keep_sound:
            capture, utterance = replace(capture, audio=None), replace(utterance, audio=None)
        loaded.append((capture, utterance))
    check_word_tier(description, tiers)
    return loaded, skipped


def _said(
    description: CorpusDescription, name: str, labels: Labels, capture: Capture, phones: PhoneSet
) -> Utterance:
    return recorded_utterance(
        name,
        labels,
        capture.audio,
        phones,
        phone_tier=description.phone_tier,
        word_tier=description.word_tier,
        duration_s=capture.times_s[-1],
        language=description.language,
    )


def _nothing_said(name: str, capture: Capture, phones: PhoneSet) -> Utterance:
    """Return the utterance of a recording without labels: silence, as long as its motion."""
    whole = Interval(0.0, max(float(capture.times_s[-1]), 1.0 / capture.rate_hz), phones.silence)
    return Utterance(name, "", Tier("phones", (whole,)), audio=capture.audio)


def _usable(
    description: CorpusDescription,
    loaded: list[tuple[Capture, Utterance]],
    skipped: dict[str, str],
    silence: str,
) -> list[tuple[Capture, Utterance]]:
    """Return the recordings that units can be cut from; the others are entered in `skipped`."""
    if not loaded:
        return loaded
    names = usual_markers(capture for capture, _ in loaded)
    loaded = [(in_order_of(capture, names), utterance) for capture, utterance in loaded]
    usual = next(utterance.name for capture, utterance in loaded if capture.names == names)
    columns = reference_columns(description, next(c for c, _ in loaded if c.names == names))
    kept = []
    for capture, utterance in loaded:
        if capture.names != names:
            skipped[utterance.name] = f"its markers differ from those of '{usual}'."
        elif problem := motion_problem(capture, utterance, columns, silence):
            skipped[utterance.name] = problem
        else:
            kept.append((capture, utterance))
    keep = seen_markers(c for c, _ in kept) if kept else []
    return [(c if len(keep) == len(c.names) else chosen_markers(c, keep), u) for c, u in kept]


def read_corpus(
    folder: str | Path,
    progress: Progress = silent,
    keep_sound: bool = True,
    unlabelled: bool = False,
) -> RawCorpus:
    """Read every usable recording of a corpus; nothing is cleaned yet.

    Parameters
    ----------
    folder : path
    progress : callable
        ``progress(fraction, what)``; may raise to cancel.
    keep_sound : bool
        Keep the sound of the recordings, which takes more memory than their motion.
    unlabelled : bool
        Take recordings without labels too, as silence: they can be cleaned, but not spoken with.

    Raises
    ------
    CorpusError
        No corpus there, or no recording in it can be used; the sentence says what was expected.
    """
    description = read_description(folder)
    phones = phone_set(description.phones)
    files = [f for f in find_recordings(description) if f.id not in description.exclude]
    loaded, skipped = _load(description, files, phones, progress, keep_sound, unlabelled)
    loaded = _usable(description, loaded, skipped, phones.silence)
    if not files:
        raise CorpusError(
            f"'exclude' in '{description.file}' leaves out every recording; take some from that list."
        )
    if not loaded:
        first = next(iter(skipped.items()))
        raise CorpusError(
            f"No recording of '{description.folder}' can be used; the first, '{first[0]}': {first[1]}"
        )
    if "head" in (only := set(loaded[0][0].regions)) and len(only) == 1:
        raise CorpusError(
            f"The recordings of '{description.folder}' show head markers only "
            f"({loaded[0][0].names[0]}, ...); markers on the face are needed too: check their names."
        )
    captures, utterances = zip(*loaded, strict=True)
    return RawCorpus(description, phones, captures, utterances, skipped)


def joined_corpora(corpus: RawCorpus, other: RawCorpus) -> RawCorpus:
    """Return both corpora as one, under the description of the first; ids of the second get its name before.

    Raises
    ------
    CorpusError
        The phone sets differ, or the second lacks markers of the first.
    """
    name = other.description.name
    if corpus.phones.name != other.phones.name:
        raise CorpusError(
            f"'{other.description.file}' has the phones '{other.phones.name}' and "
            f"'{corpus.description.file}' has '{corpus.phones.name}': the same phone set was expected."
        )
    markers = corpus.captures[0].names
    missing = [m for m in markers if m not in other.captures[0].names]
    if missing:
        raise CorpusError(
            f"The recordings of '{other.description.folder}' have no marker '{missing[0]}', which those of "
            f"'{corpus.description.folder}' have: the same markers were expected."
        )
    moved = [chosen_markers(c, [int(i) for i in c.indices(markers)]) for c in other.captures]
    named = [replace(u, name=f"{name}/{u.name}") for u in other.utterances]
    return RawCorpus(
        corpus.description,
        corpus.phones,
        (*corpus.captures, *moved),
        (*corpus.utterances, *named),
        corpus.skipped | {f"{name}/{k}": v for k, v in other.skipped.items()},
    )


def cleaned_recordings(
    raw: RawCorpus,
    config: ConfigBase | None = None,
    learn_from: Collection[str] | None = None,
    progress: Progress = silent,
) -> tuple[tuple[Recording, ...], float]:
    """Return the face markers of all recordings, cleaned, and the spread of the head scale taken out.

    Parameters as of :func:`clean_corpus`. What the same program cleaned before, learning from all of the same
    recordings with the same settings, is taken from the user's cache (:mod:`corpus_tools.pipeline.kept`).
    """
    name = ""
    if learn_from is None:
        columns = reference_columns(raw.description, raw.captures[0])
        settings = (config or Config()).cleaning.model_dump(mode="json")
        name = kept_name(raw.captures, [settings, columns, raw.description.head_scale])
    kept = read_kept(name, raw.captures) if name else None
    if kept is None:
        cleaned = clean_corpus(raw, config, learn_from, progress)
        kept = cleaned.captures, cleaned.scale_sd
        if name:
            keep(name, raw.captures, *kept)
    pairs = zip(kept[0], raw.utterances, strict=True)
    return tuple(Recording(utterance, face_only(capture)) for capture, utterance in pairs), kept[1]


def clean_corpus(
    raw: RawCorpus,
    config: ConfigBase | None = None,
    learn_from: Collection[str] | None = None,
    progress: Progress = silent,
) -> CleanedCorpus:
    """Return all recordings cleaned, head markers included, and what was taken out of them.

    Parameters
    ----------
    raw : RawCorpus
    config : config, optional
        Its section `cleaning`; the defaults when None.
    learn_from : collection of str, optional
        Recordings that may say what the head and the face look like; all when None. Those of a held-out
        recording never enter the cleaning of the others then.
    progress : callable
        ``progress(fraction, what)``; may raise to cancel.
    """
    settings = (config or Config()).cleaning
    progress(0.0, "cleaning")
    return clean_captures(
        raw.captures,
        reference_columns(raw.description, raw.captures[0]),
        allow_scale=raw.description.head_scale,
        cutoff_hz=settings.cutoff_hz,
        head_cutoff_mm=settings.head_cutoff_mm,
        iterations=settings.head_iterations,
        head_support=settings.head_support,
        gap_method=settings.gap_method,
        gap_longest_s=settings.gap_longest_s,
        gap_doubt_mm=settings.gap_doubt_mm,
        gap_components=settings.gap_components,
        outliers=settings.outliers,
        noise=settings.noise,
        names=raw.names,
        learn_from=None if learn_from is None else [i for i, n in enumerate(raw.names) if n in learn_from],
        progress=progress,
    )
