"""From labels to target utterances: contiguous timed phones with silence at both ends."""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import replace

import numpy as np

from corpus_tools.core import Audio, Interval, LabelError, Labels, Tier, Utterance
from corpus_tools.speech.phone_sets import PhoneSet
from corpus_tools.speech.syllables import with_syllables

__all__ = ["END_SILENCE_S", "labelled_utterance", "recorded_utterance", "timed_phones"]

_VARIANT = re.compile(r"\(\d+\)$")
"""How aligners mark the second pronunciation of a word: "with(2)"; labels keep it, the text does not."""

END_SILENCE_S = 0.2
"""Silence added before or after labels that begin or end with speech (our choice: room for the mouth to open
from rest and to come back to it)."""

_JOINT_S = 1e-4

LONGEST_S = 3600.0
"""No target lasts an hour (our choice): such labels are in another unit than seconds, or damaged."""


LONGER_S = 1.0
"""Sound that goes on for longer than this after all that is known of it is not waited for (our choice: a head
that rests for the rest of another recording is of no use)."""


def _sounding_s(audio: Audio, known_s: float) -> float:
    return audio.duration_s if audio.duration_s <= known_s + LONGER_S else known_s


def _normalised(tier: Tier, phones: PhoneSet, source: str) -> list[Interval]:
    rows = []
    for interval in tier:
        try:
            phone = phones.normalise(interval.text)
        except LabelError as error:
            raise LabelError(f"{source}, tier '{tier.name}' at {interval.start_s:.3f} s: {error}") from None
        rows.append(Interval(interval.start_s, interval.end_s, phone))
    return rows


def _without_holes(rows: list[Interval], silence: str) -> list[Interval]:
    """Return rows that touch: holes become silence, joints closer than 0.1 ms are closed."""
    out: list[Interval] = []
    for row in rows:
        if out and row.start_s > out[-1].end_s + _JOINT_S:
            out.append(Interval(out[-1].end_s, row.start_s, silence))
        start = out[-1].end_s if out else row.start_s
        if row.end_s - start > _JOINT_S:
            out.append(Interval(start, row.end_s, row.text))
    return out


def _merged(rows: list[Interval], silence: str) -> list[Interval]:
    out: list[Interval] = []
    for row in rows:
        if out and row.text == silence and out[-1].text == silence:
            out[-1] = Interval(out[-1].start_s, row.end_s, silence)
        else:
            out.append(row)
    return out


def timed_phones(tier: Tier, phones: PhoneSet, duration_s: float, source: str = "labels") -> Tier:
    """Return the phones of a tier as a target needs them.

    Blank and silence labels become the set's silence, neighbouring silences are merged, holes between labels
    are silence, and the row begins at 0 s and ends at `duration_s` (or at the last label, if that is later)
    with a silence on both ends.

    Parameters
    ----------
    tier : Tier
    phones : PhoneSet
    duration_s : float
        Length of the sound or motion that goes with the labels, s.
    source : str
        File or recording, for messages.

    Raises
    ------
    LabelError
        A label outside the phone set (with tier, time and the nearest phone), or nothing but silence.
    """
    rows = _normalised(tier, phones, source)
    if not any(r.text != phones.silence for r in rows):
        raise LabelError(f"{source}: tier '{tier.name}' holds no phones, only silence; label it first.")
    if rows[0].start_s > _JOINT_S:
        rows.insert(0, Interval(0.0, rows[0].start_s, phones.silence))
    elif rows[0].end_s > 0:
        rows[0] = Interval(0.0, rows[0].end_s, rows[0].text)
    if duration_s > rows[-1].end_s + _JOINT_S:
        rows.append(Interval(rows[-1].end_s, duration_s, phones.silence))
    rows = _merged(_without_holes(rows, phones.silence), phones.silence)
    if rows[-1].text != phones.silence:
        rows.append(Interval(rows[-1].end_s, rows[-1].end_s + END_SILENCE_S, phones.silence))
    if rows[0].text != phones.silence:
        rows = _with_leading_silence(rows, phones.silence)
    return Tier("phones", tuple(rows))


def _with_leading_silence(rows: list[Interval], silence: str) -> list[Interval]:
    """Give speech that begins at the very start of a file a short silence of its own, inside its first phone.

    Times cannot move, for they belong to the sound; at most a quarter of the phone and 40 ms are taken (our
    choice: below the error of automatic labels).
    """
    first = rows[0]
    cut = first.start_s + min(0.25 * first.duration_s, 0.04)
    return [Interval(first.start_s, cut, silence), Interval(cut, first.end_s, first.text), *rows[1:]]


def _stress(tier: Tier, timed: Tier, phones: PhoneSet) -> tuple[int, ...] | None:
    """Return the stress that the digits of labels tell of each phone, -1 without one; None without any."""
    if not phones.strip_stress:
        return None
    starts = [i.start_s for i in tier]
    texts = [tier.intervals[max(0, bisect_right(starts, p.centre_s) - 1)].text.strip() for p in timed]
    vowels = (p.text in phones.vowels for p in timed)
    told = zip(texts, vowels, strict=True)
    found = tuple(int(text[-1]) if vowel and text.endswith(("0", "1", "2")) else -1 for text, vowel in told)
    return found if max(found) >= 0 else None


def _words(labels: Labels, word_tier: str, phones: PhoneSet) -> Tier | None:
    if word_tier not in labels.names:
        return None
    rows = (i for i in labels.tier(word_tier) if i.text.strip().lower() not in phones.silence_words)
    return Tier("words", tuple(rows))


def _utterance(
    name: str,
    labels: Labels,
    audio: Audio | None,
    phones: PhoneSet,
    phone_tier: str,
    word_tier: str,
    duration_s: float,
    source: str,
    engine: str,
    language: str,
) -> Utterance:
    try:
        tier = labels.tier(phone_tier)
    except LabelError as error:
        raise LabelError(f"{source}: {error}") from None
    words = _words(labels, word_tier, phones)
    text = " ".join(_VARIANT.sub("", i.text) for i in words) if words else ""
    timed = timed_phones(tier, phones, duration_s, source)
    stress = _stress(tier, timed, phones)
    made = Utterance(name, text, timed, words=words, audio=audio, engine=engine, stress=stress)
    return with_syllables(made, language, phones)


def recorded_utterance(
    name: str,
    labels: Labels,
    audio: Audio | None,
    phones: PhoneSet,
    *,
    phone_tier: str = "phones",
    word_tier: str = "words",
    duration_s: float | None = None,
    language: str = "en",
) -> Utterance:
    """Return what is said in a recording as a target utterance (engine "recorded").

    Parameters
    ----------
    name : str
        Id of the recording.
    labels : Labels
    audio : Audio or None
    phones : PhoneSet
    phone_tier, word_tier : str
        Which tiers hold phones and words; words may be missing.
    duration_s : float
        Length of the motion, s: that of the utterance when there is no audio, or when the audio goes on for
        more than :data:`LONGER_S` after motion and labels.
    language : str
        Of the corpus: that of the syllables.
    """
    length = labels.end_s if duration_s is None else duration_s
    if audio:
        length = _sounding_s(audio, max(length, labels.end_s))
    return _utterance(
        name, labels, audio, phones, phone_tier, word_tier, length, f"'{name}'", "recorded", language
    )


def labelled_utterance(
    name: str,
    labels: Labels,
    audio: Audio | None,
    phones: PhoneSet,
    *,
    phone_tier: str = "phones",
    word_tier: str = "words",
    source: str | None = None,
    language: str = "en",
) -> Utterance:
    """Return a target utterance from a label file (engine "labels"); without audio it is silent.

    Parameters are those of :func:`recorded_utterance`; `source` names the file in messages.

    Raises
    ------
    LabelError
        The tier is missing, a phone is outside the set, or labels and audio do not belong together.
    """
    where = f"'{source or name}'"
    length = _sounding_s(audio, labels.end_s) if audio else labels.end_s
    if labels.end_s > LONGEST_S:
        raise LabelError(
            f"{where} goes on to {labels.end_s:g} s; at most {LONGEST_S:g} s can be spoken: check that its "
            "times are seconds, or cut it into sentences."
        )
    if audio and labels.end_s > audio.duration_s + 0.5:
        raise LabelError(
            f"{where} goes on to {labels.end_s:.3f} s but the audio ends at {audio.duration_s:.3f} s; "
            "give the sound that was labelled."
        )
    utterance = _utterance(
        name, labels, audio, phones, phone_tier, word_tier, length, where, "labels", language
    )
    if audio is not None:
        return utterance
    silent = Audio(np.zeros(round(16000 * utterance.duration_s), np.float32), 16000)
    return replace(utterance, audio=silent)
