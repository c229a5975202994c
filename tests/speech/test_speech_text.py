"""Text becomes words: numbers, times, abbreviations in full; what cannot be spoken costs one sentence."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import InputError
from corpus_tools.speech import MOST_CHARACTERS, check_text, normalise_text
from corpus_tools.speech.numbers import cardinal, number_words, ordinal


def said(text, **how):
    return " ".join(w.text + w.after for w in normalise_text(text, **how))


READ = {
    "place blue by f two now": "place blue by f two now",
    "10:15": "ten fifteen",
    "10:05": "ten oh five",
    "10:00": "ten o'clock",
    "15:00": "fifteen hundred",
    "2 pm": "two p m",
    "2pm": "two p m",
    "2 P.M.": "two p m",
    "at 3:05 p.m. or 3.30am": "at three oh five p m or three thirty a m",
    "five past one am": "five past one a m",
    "exactly one PM": "exactly one p m",
    "which one am I": "which one am I",
    "I am here": "I am here",
    "1st, 2nd, 3rd, 4th": "first, second, third, fourth",
    "the 21st and the 112th": "the twenty-first and the one hundred and twelfth",
    "20th 30th 100th 1000th": "twentieth thirtieth one hundredth one thousandth",
    "0 7 12 40 99": "zero seven twelve forty ninety-nine",
    "100 105 1205": "one hundred one hundred and five twelve oh five",
    "1,205": "one thousand two hundred and five",
    "1,000,000": "one million",
    "1984 1900 2009": "nineteen eighty-four nineteen hundred two thousand and nine",
    "007": "zero zero seven",
    "3.14": "three point one four",
    "-5 degrees": "minus five degrees",
    "5-10": "five to ten",
    "5%": "five percent",
    "1 kg 2 kg 250ms": "one kilogram two kilograms two hundred and fifty milliseconds",
    "21° at": "twenty-one degrees at",
    "$5, £1.50, €2.01": "five dollars, one pound and fifty pence, two euros and one cent",
    "Dr. Smith, Mr Jones": "doctor Smith, mister Jones",
    "St. Ives on Dec. 4th": "saint Ives on december fourth",
    "the cat sat.": "the cat sat.",
    "He sat. Then he ran.": "He sat. Then he ran.",
    "etc. e.g. this, i.e. that": "et cetera for example this, that is that",
    "U.S. wine & cheese": "u s wine and cheese",
    "don’t — “stop” (now)…": "don't stop, now.",
    "twenty-five o'clock": "twenty-five o'clock",
    "well...": "well.",
    "really?!": "really!",
    "naïve café": "naïve café",
    "B2B mp3": "B two B mp three",
    "and/or": "and or",
    "½ a": "a half a",
    "١٥ x": "fifteen x",
    "one\ntwo\tthree": "one two three",
    "ze\u00adro": "zero",
    "'tis": "tis",
}


@pytest.mark.parametrize("text", READ)
def test_english_is_read_as_people_read_it(text):
    assert said(text) == READ[text]


@pytest.mark.parametrize(
    ("text", "letters"),
    [
        ("place blue by a two now", "a"),
        ("place blue by a nine soon", "a"),
        ("a cat", ""),
        ("a hundred", ""),
        ("the letter a", "a"),
        ("a, b and c", "abc"),
        ("A cat has A or B", "AB"),
        ("I see", ""),
        ("place red in i one", "i"),
        ("by u two", "u"),
    ],
)
def test_letters_are_told_from_words_of_one_letter(text, letters):
    assert "".join(w.text for w in normalise_text(text) if w.letter) == letters


def test_z_is_called_as_the_corpus_or_the_language_calls_it():
    assert said("by z two") == "by zee two"
    assert said("by Z two", language="en-gb") == "by zed two"
    assert said("by z two", vocabulary={"zed", "two"}) == "by zed two"
    assert said("by z two", language="en-gb", vocabulary={"zee"}) == "by zee two"


def test_other_languages_keep_their_words():
    assert said("¿Cómo estás, a las 2?", language="es-419") == "Cómo estás, a las 2?"
    assert not any(w.letter for w in normalise_text("a b", language="es"))


REFUSED = {
    "": "is empty",
    "   \n": "is empty",
    "...": "'...' holds no word",
    "?!,;": "holds no word",
    "--- '' ()": "holds no word",
    "bin\x01blue": "Character 4 of the text (after 'bin') is the control character U+0001",
    "\x00": "Character 1 of the text is the control character U+0000",
    "a\x7f": "U+007F",
    "tab\u202eleft": "U+202E",
    "half \udcff": "is a byte that is no UTF-8 U+DCFF",
    "now " * (MOST_CHARACTERS // 4 + 1): f"at most {MOST_CHARACTERS}",
    "x" * 100_000: "100000 characters",
    "добрый day": "'д' (U+0434)",
    "now ☕": "'☕' (U+2615)",
    "five 五": "'五'",
    "+": "holds no word",
    "10²": "'²' (U+00B2)",
    "it is 25:99": "'25:99' in the text is no time of day",
    "it is 25:59": "'25:59'",
    "it is 12:60": "'12:60'",
    "it is 24:01 now": "'24:01'",
    "at 30 pm": "'30 pm'",
    "<speak>now</speak>": "the markup '<speak>'",
    'now <break time="1s"/> five': """the markup '<break time="1s"/>'""",
    "now </p>": "'</p>'",
    "<?xml version='1.0'?> now": "the markup '<?xml",
    "<audio\nsrc='x'>": "the markup '<audio src='x'>'",
}


@pytest.mark.parametrize("text", REFUSED, ids=lambda t: repr(t[:12]))
def test_what_cannot_be_spoken_costs_one_sentence(text):
    with pytest.raises(InputError) as caught:
        normalise_text(text)
    sentence = str(caught.value)
    assert REFUSED[text] in sentence
    assert len(sentence) < 300
    assert "\n" not in sentence


@given(hour=st.integers(0, 99), minute=st.integers(0, 99))
def test_a_time_is_read_or_refused_by_its_numbers(hour, minute):
    text = f"it is {hour}:{minute:02d}"
    if minute < 60 and (hour < 24 or (hour == 24 and minute == 0)):
        assert said(text).startswith(f"it is {cardinal(hour)} ")
    else:
        with pytest.raises(InputError, match="no time of day"):
            said(text)


@pytest.mark.parametrize(
    "text", ["one < two", "two > one", "a <3 b", "< now >", "one <- two", "<now", "5 <x and x>3"]
)
def test_single_angles_are_no_markup(text):
    assert normalise_text(text)


def test_the_longest_text_is_taken():
    check_text("x" * MOST_CHARACTERS)
    with pytest.raises(InputError):
        check_text("x" * (MOST_CHARACTERS + 1))


@given(st.text(max_size=80), st.sampled_from(["en", "en-gb", "es-419", "fr"]))
def test_any_text_gives_plain_words_or_one_sentence(text, language):
    sentences = []
    try:
        words = normalise_text(text, language)
    except InputError as error:
        sentences.append(str(error))
        return
    finally:
        assert all(len(s.splitlines()) == 1 for s in sentences)
    assert words
    for word in words:
        assert any(sign.isalnum() for sign in word.text)
        assert not set(word.text) & set(" \t\n[]<>\x00")
        assert word.after in ("", *".,;:!?")
    if language.startswith("en"):
        assert not any(sign.isdecimal() for w in words for sign in w.text)


def value(words):
    """Return the number that words say: the other way round, written apart from the code under test."""
    small = {cardinal(k): k for k in range(100)}
    total = group = 0
    for word in words.replace(" and ", " ").split():
        if word == "hundred":
            group *= 100
        elif word in ("thousand", "million", "billion", "trillion"):
            total += group * 1000 ** (1 + ("thousand", "million", "billion", "trillion").index(word))
            group = 0
        else:
            group += small[word]
    return total + group


@given(st.integers(0, 10**15 - 1))
def test_cardinals_say_their_number(n):
    assert value(cardinal(n)) == n


def test_small_numbers_are_spelled_right():
    assert [cardinal(n) for n in (0, 13, 20, 21, 110)] == [
        "zero",
        "thirteen",
        "twenty",
        "twenty-one",
        "one hundred and ten",
    ]
    assert len({cardinal(n) for n in range(2000)}) == 2000


@given(st.integers(0, 10**12))
def test_ordinals_differ_from_cardinals_in_their_last_word_alone(n):
    one, other = cardinal(n), ordinal(n)
    assert one != other
    assert one.replace("-", " ").split()[:-1] == other.replace("-", " ").split()[:-1]
    assert other.endswith(("th", "first", "second", "third"))


@given(st.text("0123456789", min_size=1, max_size=40))
def test_every_row_of_digits_is_read(text):
    assert number_words(text).replace("-", " ").replace(" ", "").isalpha()
