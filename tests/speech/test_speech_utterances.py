"""From labels to timed phones: contiguous, silent at both ends, times never moved."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Audio, Interval, LabelError, Labels, Tier
from corpus_tools.speech import labelled_utterance, phone_set, recorded_utterance, timed_phones

PHONES = phone_set("arpabet")


def tier(*rows, name="phones"):
    return Tier(name, tuple(Interval(a, b, text) for a, b, text in rows))


def rows(made):
    return [(i.start_s, i.end_s, i.text) for i in made]


LABELS = Labels(
    (
        tier((0.0, 0.2, ""), (0.2, 0.3, "b"), (0.3, 0.5, "IH1"), (0.5, 0.6, "N"), (0.6, 1.0, "sil")),
        tier((0.0, 0.2, ""), (0.2, 0.6, "bin"), (0.6, 1.0, "sil"), name="words"),
    ),
    0.0,
    1.0,
)
TONE = Audio(np.zeros(16000, np.float32), 16000)


def test_labels_that_are_complete_stay_as_they_are():
    made = timed_phones(LABELS.tier("phones"), PHONES, 1.0)
    assert rows(made) == [
        (0.0, 0.2, "SIL"),
        (0.2, 0.3, "B"),
        (0.3, 0.5, "IH"),
        (0.5, 0.6, "N"),
        (0.6, 1.0, "SIL"),
    ]


def test_silences_of_any_name_side_by_side_become_one():
    made = timed_phones(tier((0, 0.1, ""), (0.1, 0.2, "SIL"), (0.2, 0.3, "B"), (0.3, 0.4, "sp")), PHONES, 0.5)
    assert rows(made) == [(0.0, 0.2, "SIL"), (0.2, 0.3, "B"), (0.3, 0.5, "SIL")]


def test_holes_are_silence():
    made = timed_phones(tier((0.1, 0.2, "B"), (0.3, 0.4, "IY")), PHONES, 0.6)
    assert [i.text for i in made] == ["SIL", "B", "SIL", "IY", "SIL"]
    assert rows(made)[2] == (0.2, 0.3, "SIL")


def test_a_joint_that_rounding_left_open_is_closed():
    made = timed_phones(tier((0.00001, 0.1, ""), (0.1, 0.2, "B"), (0.20002, 0.3, "IY")), PHONES, 0.5)
    assert rows(made) == [(0.0, 0.1, "SIL"), (0.1, 0.2, "B"), (0.2, 0.3, "IY"), (0.3, 0.5, "SIL")]


def test_speech_up_to_the_very_end_is_followed_by_silence():
    made = timed_phones(tier((0, 0.1, ""), (0.1, 0.5, "B")), PHONES, 0.5)
    assert rows(made)[-2:] == [(0.1, 0.5, "B"), (0.5, 0.7, "SIL")]


def test_speech_from_the_very_start_keeps_its_times():
    made = timed_phones(tier((0.0, 0.4, "B"), (0.4, 0.5, "")), PHONES, 0.5)
    assert [i.text for i in made] == ["SIL", "B", "SIL"]
    assert made.intervals[0].start_s == 0
    assert made.intervals[1].start_s == pytest.approx(0.04)
    assert made.intervals[1].end_s == 0.4


def test_labels_longer_than_the_sound_keep_their_end():
    made = timed_phones(tier((0, 0.1, ""), (0.1, 0.5, "B"), (0.5, 0.8, "")), PHONES, 0.6)
    assert made.intervals[-1].end_s == 0.8


@st.composite
def label_tiers(draw):
    texts = draw(st.lists(st.sampled_from(["", "sp", "SIL", "B", "iy", "AH0", "K"]), min_size=1, max_size=12))
    texts.insert(draw(st.integers(0, len(texts))), "M")
    time, made = draw(st.sampled_from([0.0, 0.13])), []
    for text in texts:
        time += draw(st.sampled_from([0.0, 0.0, 0.05]))
        end = time + draw(st.floats(0.011, 0.4))
        made.append((time, end, text))
        time = end
    return tier(*made), time + draw(st.sampled_from([-0.05, 0.0, 0.3]))


@given(label_tiers())
def test_timed_phones_are_contiguous_and_silent_at_both_ends(case):
    labels, duration_s = case
    made = timed_phones(labels, PHONES, duration_s).intervals
    assert made[0].start_s == 0
    assert made[0].text == made[-1].text == "SIL"
    assert made[-1].end_s >= duration_s - 1e-4
    for a, b in itertools.pairwise(made):
        assert a.end_s == b.start_s
        assert (a.text, b.text) != ("SIL", "SIL")
    spoken = [i for i in labels if PHONES.normalise(i.text) != "SIL"]
    found = [i for i in made if i.text != "SIL"]
    assert [PHONES.normalise(i.text) for i in spoken] == [i.text for i in found]
    assert [i.end_s for i in spoken] == [i.end_s for i in found]


@given(label_tiers())
def test_timed_phones_of_timed_phones_are_the_same(case):
    once = timed_phones(*case[:1], PHONES, case[1])
    assert timed_phones(once, PHONES, once.intervals[-1].end_s) == once


def test_a_foreign_label_is_named_with_file_tier_and_time():
    with pytest.raises(LabelError, match=r"a\.TextGrid, tier 'phones' at 0\.100 s: 'QQ' is no phone"):
        timed_phones(tier((0, 0.1, ""), (0.1, 0.2, "QQ")), PHONES, 1.0, source="a.TextGrid")


def test_nothing_but_silence_is_refused():
    with pytest.raises(LabelError, match="only silence; label it first"):
        timed_phones(tier((0, 0.1, ""), (0.1, 0.2, "sp")), PHONES, 1.0)
    with pytest.raises(LabelError, match="only silence"):
        timed_phones(tier(), PHONES, 1.0)


def test_a_recording_speaks_its_words():
    made = recorded_utterance("a", LABELS, TONE, PHONES)
    assert (made.name, made.text, made.engine) == ("a", "bin", "recorded")
    assert made.labels == ("SIL", "B", "IH", "N", "SIL")
    assert [w.text for w in made.words] == ["bin"]
    assert made.audio is TONE
    assert made.duration_s == 1.0


def test_without_sound_the_motion_gives_the_length():
    assert recorded_utterance("a", LABELS, None, PHONES, duration_s=1.5).duration_s == 1.5
    assert recorded_utterance("a", LABELS, None, PHONES).duration_s == 1.0


@given(beyond_s=st.floats(-0.4, 60), motion_s=st.floats(0.5, 3))
def test_sound_gives_the_length_unless_it_goes_on_for_long_after_everything(beyond_s, motion_s):
    known_s = max(1.0, motion_s)
    for known, made in (
        (known_s, lambda sound: recorded_utterance("a", LABELS, sound, PHONES, duration_s=motion_s)),
        (1.0, lambda sound: labelled_utterance("a", LABELS, sound, PHONES)),
    ):
        sound = Audio(np.zeros(round(16000 * (known + beyond_s)), np.float32), 16000)
        length_s = max(sound.duration_s, 1.0)  # what is labelled is spoken whatever the sound
        if sound.duration_s > known + 1.0:
            length_s = known
        assert made(sound).duration_s == pytest.approx(length_s)
        assert made(sound).audio is sound


def test_tiers_by_other_names_and_no_words():
    labels = Labels((tier(*rows(LABELS.tier("phones")), name="phon"),), 0.0, 1.0)
    made = recorded_utterance("a", labels, TONE, PHONES, phone_tier="phon")
    assert (made.text, made.words) == ("", None)
    with pytest.raises(LabelError, match=r"'a': There is no interval tier 'phones'; the tiers are: 'phon'"):
        recorded_utterance("a", labels, TONE, PHONES)


def test_a_label_file_alone_is_spoken_in_silence():
    made = labelled_utterance("a", LABELS, None, PHONES)
    assert made.engine == "labels"
    assert made.audio.duration_s == pytest.approx(1.0)
    assert not made.audio.samples.any()
    assert made.labels == recorded_utterance("a", LABELS, TONE, PHONES).labels


def test_a_label_file_with_its_sound_keeps_it():
    assert labelled_utterance("a", LABELS, TONE, PHONES).audio is TONE


def test_labels_and_sound_of_different_recordings_are_refused():
    short = Audio(np.zeros(4000, np.float32), 16000)
    with pytest.raises(LabelError, match=r"'x\.TextGrid' goes on to 1\.000 s but the audio ends at 0\.250 s"):
        labelled_utterance("a", LABELS, short, PHONES, source="x.TextGrid")


def test_the_text_leaves_out_how_aligners_mark_a_second_pronunciation():
    labels = Labels(
        (
            LABELS.tiers[0],
            tier(
                (0.2, 0.4, "with(2)"),
                (
                    0.4,
                    0.6,
                    "(2)",
                ),
                name="words",
            ),
        ),
        0.0,
        1.0,
    )
    made = recorded_utterance("a", labels, TONE, PHONES)
    assert made.text.split() == ["with"]
    assert [i.text for i in made.words] == ["with(2)", "(2)"]
