"""What is said of a result in a line: contacts, and the distance from the recording."""

import dataclasses

import numpy as np
import pytest

from corpus_tools.synthesis import Contact
from workbench.state import Session, Stages, distance_mm, held_out_text, lane_text
from workbench.state.said import contacts_text, missed_text


@pytest.fixture(scope="module")
def result(opened):
    session = Session()
    session.opened(opened)
    return Stages().run(session.request())


def contact(phone, made, time_s=0.5):
    return Contact(phone, 0.4, 0.6, "closed", time_s, -0.1 if made else 2.0, 0.05, made)


def test_contacts_are_counted_and_those_that_are_not_made_named():
    found = (contact("B", True), contact("P", False), contact("M", False, 1.25), contact("F", False))
    assert contacts_text(found) == "1/4 contacts"
    assert missed_text(found) == "The lips make no contact: P at 0.50 s, M at 1.25 s and 1 more"
    assert contacts_text(()) == missed_text(found[:1]) == ""


def test_a_result_says_its_contacts_and_how_far_it_lies_from_what_it_was_kept_from(result):
    n = sum(
        result.request.corpus.phones.lip_shape(p.text) in ("closed", "on teeth")
        for p in result.utterance.phones
    )
    assert lane_text(result).count(f"{n}/{n} contacts") == 1
    assert held_out_text(result).startswith("held out · ")
    assert f"{distance_mm(result):.1f} mm" in held_out_text(result)


def test_the_distance_of_a_recording_from_itself_is_none_and_that_of_a_shifted_one_its_shift(result):
    capture = result.request.corpus.recorded(result.request.sentence)
    where = [list(capture.names).index(n) for n in result.trajectory.names]
    own = np.asarray(capture.positions_mm)[:, where]
    for shift, expected in ((0.0, 0.0), (2.0, 2.0)):
        moved = own + np.array([0.0, shift, 0.0])
        trajectory = dataclasses.replace(
            result.trajectory, times_s=capture.times_s, values_mm=moved, flags=None, joins=()
        )
        assert distance_mm(dataclasses.replace(result, trajectory=trajectory)) == pytest.approx(expected)


def test_a_text_lies_from_no_recording(result):
    request = dataclasses.replace(result.request, text="half past one")
    spoken = dataclasses.replace(result, request=request)
    assert np.isnan(distance_mm(spoken))
    assert held_out_text(spoken) == ""
