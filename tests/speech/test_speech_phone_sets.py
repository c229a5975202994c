"""Phone sets: complete, without overlap, and patient with the ways people write labels."""

import tomllib
from importlib import resources

import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import InputError, LabelError
from corpus_tools.speech import phone_set, phone_set_names

ARPABET = phone_set("arpabet")
PHONES = st.sampled_from(ARPABET.phones)


@pytest.mark.parametrize("name", phone_set_names())
def test_every_phone_of_a_set_has_both_classes(name):
    phones = phone_set(name)
    assert phones.phones[0] == phones.silence
    assert len(set(phones.phones)) == len(phones.phones)
    assert set(phones.viseme_classes) == set(phones.display_classes) == set(phones.phones)
    assert phones.bilabials | phones.labiodentals | phones.vowels <= set(phones.phones)
    assert phones.silence not in phones.bilabials | phones.labiodentals | phones.vowels
    assert set(phones.aliases.values()) <= set(phones.phones)
    assert not set(phones.aliases) & set(phones.phones)
    shapes = {(phones.viseme_class(p), phones.lip_shape(p)) for p in phones.phones}
    assert len(shapes) == len(set(phones.viseme_classes.values()))  # a viseme class has one shape of lips
    shaped = phones.bilabials | phones.labiodentals | phones.rounded
    assert {p for p in phones.phones if phones.lip_shape(p)} == shaped
    for same in (phones.bilabials, phones.labiodentals):
        assert len({phones.viseme_class(p) for p in same}) == 1


def test_arpabet_has_39_phones_and_15_viseme_classes():
    assert len(ARPABET.phones) == 40  # with silence
    assert len(set(ARPABET.viseme_classes.values())) == 15
    assert len(set(ARPABET.display_classes.values())) == 9
    assert ARPABET.bilabials == {"P", "B", "M"}


@pytest.mark.parametrize("name", phone_set_names())
@pytest.mark.parametrize("kind", ["viseme_classes", "display_classes"])
def test_no_phone_is_listed_in_two_classes(name, kind):
    data = resources.files("corpus_tools.speech") / "data" / f"{name}.toml"
    classes = tomllib.loads(data.read_text(encoding="utf-8"))[kind]
    listed = [phone for members in classes.values() for phone in members]
    assert len(listed) == len(set(listed))


LOOK_ALIKE = (
    "SIL | P B M | F V | TH DH | T D N | S Z | CH JH SH ZH | K G NG HH | L | R ER | W UW UH | OW AO OY | "
    "AA AY AW | AE EH AH | EY IY IH Y"
)


def test_phones_that_look_alike_share_a_class_and_no_others_do():
    wanted = {frozenset(group.split()) for group in LOOK_ALIKE.split("|")}
    classes = {c: set() for c in ARPABET.viseme_classes.values()}
    for phone in ARPABET.phones:
        classes[ARPABET.viseme_class(phone)].add(phone)
    assert {frozenset(group) for group in classes.values()} == wanted


def test_display_classes_are_those_of_the_palette():
    shown = {c: {p for p in ARPABET.phones if ARPABET.display_class(p) == c} for c in ("coronal", "rounded")}
    assert shown["coronal"] == {"T", "D", "S", "Z", "N", "L", "TH", "DH"}
    assert shown["rounded"] == {"OW", "UW", "UH", "OY", "W"}


@given(PHONES, st.sampled_from(["", "0", "1", "2"]), st.booleans(), st.sampled_from(["", " ", "\t"]))
def test_case_stress_and_blanks_do_not_matter(phone, stress, lower, blank):
    label = blank + (phone.lower() if lower else phone) + blank
    label = label if phone == ARPABET.silence else label.strip() + stress + blank
    assert ARPABET.normalise(label) == phone


@given(PHONES)
def test_normalising_twice_changes_nothing(phone):
    assert ARPABET.normalise(ARPABET.normalise(phone)) == phone


@pytest.mark.parametrize("label", ["", "  ", "sp", "SP", "sil", "SIL", "pau", "#", "h#"])
def test_silence_has_many_names(label):
    assert ARPABET.normalise(label) == "SIL"


def test_relatives_of_phones_are_taken_for_them():
    assert [ARPABET.normalise(x) for x in ("ax", "axr", "hv", "dx")] == ["AH", "ER", "HH", "D"]


def test_a_label_outside_the_set_is_refused_with_the_nearest():
    with pytest.raises(LabelError, match=r"'IYY' is no phone of the set 'arpabet'; did you mean 'IY'\?"):
        ARPABET.normalise("IYY")


def test_an_unknown_set_is_refused_with_the_nearest():
    with pytest.raises(InputError, match="'arpabett'; did you mean 'arpabet'"):
        phone_set("arpabett")


def test_a_set_is_read_once_and_cannot_be_altered():
    assert phone_set("arpabet") is ARPABET
    with pytest.raises(TypeError):
        ARPABET.viseme_classes["P"] = "k"
