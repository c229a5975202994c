"""The transport's data: samples, phones, and what one load sends."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from corpus_tools.core import Audio, Interval, Tier, Utterance
from corpus_tools.speech import phone_set
from workbench.views.transport import Transport, pcm16


@given(hnp.arrays(np.float32, st.integers(0, 50), elements=st.floats(-1, 1, width=32)))
def test_samples_survive_to_half_a_step(samples):
    back = np.frombuffer(pcm16(samples), "<i2") / 32768.0
    assert np.all(np.abs(back - samples) <= np.where(samples > 32767 / 32768, 1, 0.5) / 32768 + 1e-12)


def test_samples_out_of_range_are_clipped_not_wrapped():
    assert list(np.frombuffer(pcm16([-3.0, -1.0, 1.0, 2.0]), "<i2")) == [-32768, -32768, 32767, 32767]


def utterance(audio):
    tier = Tier("phones", (Interval(0, 0.2, "SIL"), Interval(0.2, 0.3, "P"), Interval(0.3, 0.5, "SIL")))
    return Utterance("one", "", tier, audio=audio)


def test_one_load_is_one_update():
    transport = Transport()
    seen = []
    transport.param.watch(lambda *events: seen.append([e.name for e in events]), list(transport.param))
    transport.load(utterance(Audio(np.zeros(400), 8000)), phone_set("arpabet"), plays=True)
    assert seen == [["loaded"]]  # two values would be two messages, and the first acted on without the second
    loaded = transport.loaded
    assert (loaded["rate_hz"], loaded["duration_s"], len(loaded["pcm"])) == (8000, 0.5, 800)
    assert (loaded["n"], loaded["plays"]) == (1, True)
    assert [row[3] for row in loaded["phones"]] == ["silence", "bilabial", "silence"]


def test_without_sound_it_is_as_long_as_the_phones():
    transport = Transport()
    transport.load(utterance(None), phone_set("arpabet"))
    assert (transport.loaded["pcm"], transport.loaded["duration_s"]) == (b"", 0.5)
