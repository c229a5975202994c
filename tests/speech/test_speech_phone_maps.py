"""Every map from a notation to a phone set is whole, takes the longest match, names what it does not know."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import InputError, LabelError
from corpus_tools.speech import phone_map, phone_map_names, phone_set, phone_set_names

IPA = phone_map("ipa", "arpabet")


@pytest.mark.parametrize(("notation", "name"), phone_map_names())
def test_every_map_leads_into_its_set_and_reaches_all_of_it(notation, name):
    assert name in phone_set_names()
    mapped = phone_map(notation, name)
    reached = {p for phones in mapped.symbols.values() for p in phones}
    assert reached == set(phone_set(name).phones) - {phone_set(name).silence}
    for key, phones in mapped.symbols.items():
        assert mapped.translate(key)[0].phones == phones, key
        assert [mapped.stripped(s) for s in key] == list(key), "a mark would hide this symbol"
        assert not any(mapped.is_pause(s) for s in key), key
    for stop in mapped.stops:
        assert (stop,) in mapped.symbols, stop
    for pause in mapped.pauses:
        assert mapped.translate([pause])[0].phones == (phone_set(name).silence,)


@pytest.mark.parametrize(("notation", "name"), phone_map_names())
def test_an_unknown_symbol_is_named(notation, name):
    with pytest.raises(LabelError, match=rf"{notation} symbol 'ǂ'.*'{name}'"):
        phone_map(notation, name).translate(["ǂ"])


@given(st.lists(st.sampled_from(sorted(k[0] for k in IPA.symbols)), min_size=1, max_size=12), st.data())
def test_strings_of_symbols_are_split_without_loss(symbols, data):
    text = "".join(data.draw(st.sampled_from(["", "ˈ", "ˌ"])) + s for s in symbols)
    split = IPA.split(text)
    assert "".join(split) == "".join(symbols)
    assert len(split) <= len(symbols), "the longest match"
    places = [k for m in IPA.translate(split) for k in range(m.first, m.last + 1)]
    assert places == list(range(len(split)))


@pytest.mark.parametrize(
    ("text", "phones"),
    [
        ("ðəˈtaɪm", "DH AH T AY M"),
        ("tʃɜːtʃ", "CH ER CH"),
        ("t͡ʃiːz", "CH IY Z"),
        ("fɔːɹ", "F AO R"),
        ("faɪɚ", "F AY ER"),
        ("ˈɑːftəˌnuːn", "AA F T AH N UW N"),
        ("ɡəʊ", "G OW"),
        ("ʍɪtʃ", "HH W IH CH"),
    ],
)
def test_ipa_words(text, phones):
    assert " ".join(p for m in IPA.translate(IPA.split(text)) for p in m.phones) == phones


def test_ipa_names_the_letter_that_it_cannot_read():
    with pytest.raises(LabelError, match=r"'ɲ'.*in 'niɲo'"):
        IPA.split("niɲo")


@pytest.mark.parametrize(
    ("symbols", "phones"),
    [
        ("z 'i@ r oU", "Z IH R OW"),
        ("aI d 'i@", "AY D IY AH"),
        ("f 'o@", "F AO R"),
        ("f 'o@ r", "F AO R"),
        ("D I2 ;", "DH IY"),
        ("D I2 ; 'a p", "DH IY AE P"),
        ("b I2 k", "B IH K"),
        ("'aU 3", "AW ER"),
        ("l 'I t# @L", "L IH T AH L"),
        ("n _: n", "N SIL N"),
    ],
)
def test_names_of_espeak(symbols, phones):
    mapped = phone_map("espeak", "arpabet").translate(symbols.split())
    assert " ".join(p for m in mapped for p in m.phones) == phones


def test_arpabet_with_stress_and_reduced_phones():
    mapped = phone_map("arpabet", "arpabet").translate(["DH", "AX0", "B", "AO1", "T", "EL", "SIL"])
    assert [p for m in mapped for p in m.phones] == "DH AH B AO T AH L SIL".split()  # noqa: SIM905


def test_languages_of_a_map():
    assert IPA.serves("en")
    assert IPA.serves("en-GB")
    assert not IPA.serves("es-419")


def test_a_map_that_there_is_not_is_refused_by_name():
    with pytest.raises(InputError, match=r"from klingon symbols.*ipa to arpabet"):
        phone_map("klingon", "arpabet")
