"""A corpus opened for synthesis: cleaned recordings, inventory, neutral pose, natural distributions."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from corpus_tools.cleaning import neutral_pose
from corpus_tools.config import Config, ConfigBase
from corpus_tools.core import (
    SPEECH_REGIONS,
    BoolArray,
    Capture,
    FloatArray,
    FrameFlag,
    InputError,
    Recording,
    UnitInventory,
    Utterance,
    region_columns,
    speech_span_s,
)
from corpus_tools.fragments import build_inventory
from corpus_tools.fragments.posture import as_recorded, bias_rms_mm, without_bias
from corpus_tools.io import CorpusDescription
from corpus_tools.pipeline.reading import Progress, RawCorpus, cleaned_recordings, read_corpus, silent
from corpus_tools.pipeline.threads import one_thread
from corpus_tools.speech import PhoneSet, lip_aperture_mm
from corpus_tools.synthesis import (
    NaturalDistribution,
    SelectionModel,
    natural_distribution,
    prepare_selection,
)
from corpus_tools.synthesis.lips import LipModel, lip_model

__all__ = ["OpenCorpus", "nearest_of", "open_corpus"]


def nearest_of(name: str, known: Sequence[str], most: int = 3) -> str:
    """Return a clause with the known words most like `name`, nearest first, and how many there are."""
    near = difflib.get_close_matches(name, known, n=most, cutoff=0.0)
    named = ", ".join(f"'{n}'" for n in near)
    if len(known) <= len(near):
        return f"there {'is' if len(known) == 1 else 'are'} {named}"
    return f"the nearest of its {len(known)} are {named}"


@dataclass(frozen=True, slots=True, eq=False)
class OpenCorpus:
    """Everything that is computed once per corpus and cleaning settings; read-only, shared by sessions.

    Attributes
    ----------
    description : CorpusDescription
    phones : PhoneSet
    recordings : tuple of Recording
        Cleaned face markers (without the head markers) of every usable recording, freed of the posture that
        it keeps constantly where `cleaning.remove_bias` says so: units, joins and neutral are made of them.
    skipped : dict of recording id -> sentence
    model : SelectionModel
    neutral_mm : (n_markers, 3) mm
    natural : NaturalDistribution
        Of peak acceleration, for the percentiles of the join report.
    lips : LipModel
        What closure projection needs to know about the speaker's lips.
    scale_sd : float
        Spread of the head scale that was removed; 0 when scaling is off.
    offsets_mm : dict of recording id -> (n_markers, 3) mm
        The constant posture that was taken out; empty when `cleaning.remove_bias` is off.
    """

    description: CorpusDescription
    phones: PhoneSet
    recordings: tuple[Recording, ...]
    skipped: dict[str, str]
    model: SelectionModel
    neutral_mm: FloatArray
    natural: NaturalDistribution
    lips: LipModel
    scale_sd: float
    offsets_mm: dict[str, FloatArray]

    @property
    def inventory(self) -> UnitInventory:
        """The unit inventory of all usable recordings."""
        return self.model.inventory

    @property
    def names(self) -> tuple[str, ...]:
        """Ids of the usable recordings."""
        return tuple(r.name for r in self.recordings)

    @property
    def markers(self) -> tuple[str, ...]:
        """Names of the face markers."""
        return self.recordings[0].capture.names

    def recording(self, name: str) -> Recording:
        """Return a recording by id.

        Raises
        ------
        InputError
            The id is unknown, or the recording was skipped; the sentence says which and why.
        """
        for recording in self.recordings:
            if recording.name == name:
                return recording
        if name in self.skipped:
            raise InputError(f"The recording '{name}' cannot be used: {self.skipped[name]}")
        if name in self.description.exclude:
            raise InputError(
                f"The recording '{name}' is left out by 'exclude' in '{self.description.file}'; "
                "take it from that list to use it."
            )
        raise InputError(
            f"There is no recording '{name}' in '{self.description.folder}': {nearest_of(name, self.names)}."
        )

    def recorded(self, name: str) -> Capture:
        """Return the cleaned capture of a recording in its own posture: what a synthesis is compared with.

        A held-out recording is a recording like any other: nothing is taken from it that only its own motion
        can tell, so that errors against it are those of somebody who never saw it.
        """
        return as_recorded(self.recording(name).capture, self.offsets_mm.get(name))

    @property
    def bias_mm(self) -> dict[str, float]:
        """Size of the posture taken out of each recording, mm: rms length over lips and chin."""
        return bias_rms_mm(self.offsets_mm, self.recordings[0].capture.regions)

    def utterance(self, name: str) -> Utterance:
        """Return what is said in a recording, as a target utterance."""
        return self.recording(name).utterance


@one_thread
def open_corpus(
    folder: str | Path, config: ConfigBase | None = None, progress: Progress = silent
) -> OpenCorpus:
    """Read, clean and index a corpus.

    Parameters
    ----------
    folder : path
        A folder with ``corpus.toml``; nothing in it or in the folders it points to is altered.
    config : config, optional
        Its sections `cleaning`, `selection` and `closure` are used; the defaults when None.
    progress : callable
        ``progress(fraction, what)``; may raise to cancel.

    Raises
    ------
    CorpusError
        No corpus there, or no recording in it can be used; the sentence says what was expected.
    """
    config = config or Config()
    raw = read_corpus(folder, lambda f, w: progress(0.5 * f, w))
    recordings, scale_sd = cleaned_recordings(raw, config, progress=lambda f, w: progress(0.5 + 0.35 * f, w))
    phones = raw.phones
    offsets: dict[str, FloatArray] = {}
    if config.cleaning.remove_bias:
        progress(0.86, "finding postures")
        recordings, offsets = without_bias(recordings, phones.silence)
    progress(0.87, "indexing units")
    return _assemble(raw, recordings, config, scale_sd, offsets, progress)


def _silent(recording: Recording, silence: str) -> BoolArray:
    """Return the measured frames of silence, 0.1 s and more away from speech, (n_frames,)."""
    capture = recording.capture
    times = capture.times_s
    low, high = speech_span_s(recording.utterance, silence)
    assert capture.flags is not None
    measured = (capture.flags & FrameFlag.DOUBTFUL).max(axis=1) == 0
    return np.asarray(((times < low - 0.1) | (times > high + 0.1)) & measured)


def _quiet(recordings: Sequence[Recording], lips: LipModel, silence: str) -> list[BoolArray]:
    """Return the frames of silence with closed lips of every recording.

    The quarter of all silent frames in which the lips are nearest to each other counts as closed in any case:
    lips that are pressed in bilabials, or parted at rest, would leave none (our choice).
    """
    still = [_silent(r, silence) for r in recordings]
    aperture = [lip_aperture_mm(r.capture.positions_mm, r.capture.names) for r in recordings]
    pooled = np.concatenate([a[s] for a, s in zip(aperture, still, strict=True)])
    if np.isnan(lips.threshold_mm) or not len(pooled):
        return still
    limit = max(lips.threshold_mm, float(np.percentile(pooled, 25)))
    return [np.asarray(s & (a <= limit)) for a, s in zip(aperture, still, strict=True)]


def _assemble(
    raw: RawCorpus,
    recordings: tuple[Recording, ...],
    config: ConfigBase,
    scale_sd: float,
    offsets_mm: dict[str, FloatArray],
    progress: Progress,
) -> OpenCorpus:
    phones = raw.phones
    inventory = build_inventory(recordings)
    model = prepare_selection(inventory, phones, n_components=config.selection.components)
    progress(0.95, "natural distribution")
    captures = [r.capture for r in recordings]
    natural = natural_distribution(
        captures,
        rate_hz=config.alignment.rate_hz,
        columns=region_columns(captures[0].regions, SPEECH_REGIONS),
        spans_s=[speech_span_s(r.utterance, phones.silence) for r in recordings],
    )
    lips = lip_model(recordings, phones, config.closure.components)
    neutral = neutral_pose(captures, _quiet(recordings, lips, phones.silence))
    progress(1.0, "ready")
    return OpenCorpus(
        description=raw.description,
        phones=phones,
        recordings=recordings,
        skipped=raw.skipped,
        model=model,
        neutral_mm=neutral,
        natural=natural,
        lips=lips,
        scale_sd=scale_sd,
        offsets_mm=offsets_mm,
    )
