"""The embedded voice: eSpeak NG in a child process of its own, from text to sound, words and timed phones."""

from __future__ import annotations

import importlib.util
import itertools
import sys
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from corpus_tools.core import (
    Audio,
    EngineError,
    InputError,
    Interval,
    LabelError,
    MissingExtraError,
    Tier,
    Utterance,
)
from corpus_tools.core.errors import suggestion
from corpus_tools.speech.engines.child import Children
from corpus_tools.speech.engines.request import ENGINES, Engine, SpeechRequest
from corpus_tools.speech.engines.timing import SpokenPhone, spoken_phones
from corpus_tools.speech.phone_maps import PhoneMap, phone_map
from corpus_tools.speech.phone_sets import PhoneSet
from corpus_tools.speech.syllables import with_syllables
from corpus_tools.speech.text import SpokenWord, normalise_text

__all__ = ["END_SILENCE_S", "check_espeak", "espeak_version", "prepare_espeak", "speak_espeak"]

END_SILENCE_S = 0.3
"""Silence before and after speech, s (our choice: time to leave the rest pose, and to come back to it)."""

LIMIT_S = 30.0
"""An answer that takes longer is none: a text of the greatest length takes 2 s here."""

USUAL_WORDS_PER_MINUTE = 175
LEAST_RATE, MOST_RATE = 0.5, 2.5
LANGUAGES = {"en": "en-us", "es-mx": "es-419"}
"""Variants that stand for a language: American English maps onto ARPABET without loss."""

_LETTER_A = "[['eI]]"
"""The letter, where eSpeak NG would say the article."""

_INSTALL = "install it with: pip install 'visual-speech-workbench[voice]'."
_children: list[Children] = []
_heard: list[str] = []
"""The version that the last answer named."""


def _folder() -> Path:
    """Return the folder that holds the package of the library, which is not imported into this process."""
    try:
        spec = importlib.util.find_spec("espeakng_loader")
    except (ImportError, ValueError):
        spec = None
    if spec is None or not spec.submodule_search_locations:
        raise MissingExtraError(f"Speaking text needs the voice eSpeak NG, which is not there; {_INSTALL}")
    return Path(next(iter(spec.submodule_search_locations))).parent


def _process() -> Children:
    if not _children:
        worker = str(Path(__file__).with_name("espeak_worker.py"))
        command = (sys.executable, "-I", "-S", worker, str(_folder()))
        _children.append(Children(command, "the voice eSpeak NG"))
    return _children[0]


def check_espeak() -> None:
    """Raise MissingExtraError when the extra `voice` is not installed."""
    _folder()


def prepare_espeak() -> None:
    """Start the voice now, so that it is ready when it is asked; does nothing without the extra."""
    try:
        _process().prepare()
    except MissingExtraError:
        return


def espeak_version() -> str:
    """Return the versions of eSpeak NG and of the package that holds it, for manifests."""
    try:
        package = version("espeakng-loader")
    except PackageNotFoundError:
        return "absent"
    if not _heard:
        _ask(SpeechRequest("version", text="a"), (), "a")
    return f"eSpeak NG {_heard[0]} (espeakng-loader {package})"


def _written(word: SpokenWord) -> str:
    return _LETTER_A if word.letter and word.text.lower() == "a" else word.text


def _sentence(words: Sequence[SpokenWord]) -> tuple[str, list[int]]:
    """Return what eSpeak NG reads, and the place of each word in it."""
    parts: list[str] = []
    places: list[int] = []
    for word in words:
        places.append(sum(map(len, parts)))
        parts.append(_written(word) + word.after + " ")
    return "".join(parts).rstrip(), places


def _unknown(head: dict[str, Any], language: str, voice: str) -> str:
    if head["unknown"] == "language":
        family = language.lower().split("-")[0]
        has = [name for name in head["known"] if name.split("-")[0] == family]
        return f"The voice eSpeak NG has no language '{language}'; of '{family}' it has: {', '.join(has)}."
    hint = suggestion(voice, head["known"]) or f"; it has: {', '.join(head['known'])}."
    return f"The voice eSpeak NG has no voice '{voice}'{hint}"


def _ask(request: SpeechRequest, words: Sequence[SpokenWord], text: str) -> tuple[dict[str, Any], bytes]:
    language = LANGUAGES.get(request.language.lower(), request.language)
    asked = {
        "text": text,
        "language": language,
        "voice": request.voice,
        "words_per_minute": round(USUAL_WORDS_PER_MINUTE * request.rate),
        "words": [w.text for w in words],
    }
    head, sound = _process().ask(asked, LIMIT_S)
    if "unknown" in head:
        raise InputError(_unknown(head, language, request.voice))
    if "broken" in head:
        raise MissingExtraError(f"The voice eSpeak NG cannot be used ({head['broken']}); {_INSTALL}")
    if "error" in head:
        raise EngineError(f"The voice eSpeak NG cannot say this text ({head['error']}); change the text.")
    _heard[:] = [str(head["version"]).split()[0]]
    return head, sound


def _word_at(place: int, places: Sequence[int]) -> int:
    return int(np.searchsorted(places, place, side="right")) - 1


def _numbered(events: Sequence[Sequence[Any]], places: Sequence[int]) -> list[tuple[int, str, int]]:
    """Return (sample, symbol, word) of the phone events; a word event stands before its phones."""
    rows: list[tuple[int, str, int]] = []
    word = 0
    for event in events:
        if event[1] == "word":
            word = max(word, _word_at(event[2], places))
        else:
            rows.append((int(event[0]), event[2], word))
    return rows


def _with_lost_words(
    rows: list[tuple[int, str, int]], counts: Sequence[int], phone_map: PhoneMap
) -> list[tuple[int, str, int]]:
    """Give words that eSpeak NG joined to the one before ("in the") their share of its phones.

    How many phones each word has on its own says where to cut; each keeps at least one.
    """
    out: list[tuple[int, str, int]] = []
    starts = [r[2] for r in rows]
    ends = sorted(set(starts))
    for first, after in zip(ends, [*ends[1:], len(counts)], strict=True):
        mine = [r for r in rows if r[2] == first]
        spoken = [i for i, r in enumerate(mine) if not phone_map.is_pause(r[1])]
        group = range(first, after)
        if len(group) == 1 or len(spoken) < len(group):
            out += mine
            continue
        total = np.cumsum([max(1, counts[w]) for w in group])
        cuts = [round(len(spoken) * t / total[-1]) for t in total[:-1]]
        cuts = [max(c, k + 1) for k, c in enumerate(cuts)]
        cuts = [min(c, len(spoken) - (len(cuts) - k)) for k, c in enumerate(cuts)]
        bounds = [spoken[c] for c in cuts]
        out += [(r[0], r[1], first + int(np.searchsorted(bounds, i, "right"))) for i, r in enumerate(mine)]
    return out


def _tiers(
    spoken: list[SpokenPhone], words: Sequence[SpokenWord], length_s: float, silence: str
) -> tuple[Tier, Tier]:
    """Return phones with silence at both ends, and words; times on the padded clock."""
    starts = [p.start_s + END_SILENCE_S for p in spoken] + [length_s + END_SILENCE_S]
    rows = [Interval(0.0, starts[0], silence)]
    named: dict[int, list[float]] = {}
    for phone, (low, high) in zip(spoken, itertools.pairwise(starts), strict=True):
        if phone.phone == silence and rows[-1].text == silence:
            rows[-1] = Interval(rows[-1].start_s, high, silence)
            continue
        rows.append(Interval(low, high, phone.phone))
        if phone.phone != silence:
            span = named.setdefault(phone.word, [low, high])
            span[1] = high
    end_s = length_s + 2 * END_SILENCE_S
    if rows[-1].text == silence:
        rows[-1] = Interval(rows[-1].start_s, end_s, silence)
    else:
        rows.append(Interval(rows[-1].end_s, end_s, silence))
    spans = (Interval(low, high, words[k].text) for k, (low, high) in sorted(named.items()))
    return Tier("phones", tuple(rows)), Tier("words", tuple(spans))


def _stress(spoken: Sequence[SpokenPhone], tier: Tier) -> tuple[int, ...]:
    told = {p.start_s + END_SILENCE_S: p.stress for p in spoken}
    return tuple(told.get(phone.start_s, -1) for phone in tier)


def _padded(samples: npt.NDArray[np.int16], rate_hz: int) -> Audio:
    quiet = np.zeros(round(END_SILENCE_S * rate_hz), np.float32)
    sound = samples.astype(np.float32) / np.float32(32768)
    return Audio(np.concatenate([quiet, sound, quiet]), rate_hz)


def _check(request: SpeechRequest, symbols: PhoneMap) -> None:
    if not symbols.serves(request.language):
        raise InputError(
            f"The phone set '{symbols.phones.name}' of the corpus holds the phones of "
            f"{', '.join(symbols.languages)}, not of '{request.language}'; speak another language, or take a "
            "corpus of this one."
        )
    if not LEAST_RATE <= request.rate <= MOST_RATE:
        raise InputError(
            f"The speaking rate is {request.rate:g}; {LEAST_RATE:g} to {MOST_RATE:g} was expected "
            "(1 is the usual rate, 2 twice as fast)."
        )


def speak_espeak(request: SpeechRequest, phones: PhoneSet) -> Utterance:
    """Speak a text with eSpeak NG: sound at 22 050 Hz, words, phones in the set of the corpus.

    A stop begins with its closure, and a sound that is two phones in the set is split. eSpeak NG reports a
    vowel after a nasal or a liquid up to 50 ms late (it counts the transition to the consonant).

    Raises
    ------
    MissingExtraError
        The extra `voice` is not installed.
    InputError, LabelError
        Text, language, voice or rate that cannot be spoken, or a sound that the phone set does not have.
    EngineError
        The voice died twice, or did not answer.
    """
    symbols = phone_map("espeak", phones.name)
    _check(request, symbols)
    words = normalise_text(request.text, request.language, request.vocabulary)
    text, places = _sentence(words)
    head, sound = _ask(request, words, text)
    samples = np.frombuffer(sound, np.int16)
    rate_hz = int(head["rate_hz"])
    rows = _with_lost_words(_numbered(head["events"], places), head["word_phones"], symbols)
    try:
        spoken = spoken_phones(samples, rate_hz, rows, symbols)
    except LabelError as error:
        raise LabelError(f"'{request.name}' as '{request.language}' says it: {error}") from None
    if not any(p.phone != phones.silence for p in spoken):
        raise InputError(f"The voice eSpeak NG says nothing for '{request.text.strip()[:60]}'; write words.")
    tier, word_tier = _tiers(spoken, words, len(samples) / rate_hz, phones.silence)
    made = Utterance(
        request.name,
        " ".join(w.text for w in words),
        tier,
        words=word_tier,
        audio=_padded(samples, rate_hz),
        engine="espeak",
        stress=_stress(spoken, tier),
    )
    return with_syllables(made, request.language, phones)


ENGINES.add(
    "espeak",
    Engine(
        "espeak",
        "The embedded voice, eSpeak NG: the same on every machine.",
        "text",
        speak_espeak,
        check_espeak,
        espeak_version,
    ),
)
