"""What the library does without a config is what a config does that nobody changed."""

import inspect

import pytest

from corpus_tools.cleaning import clean_captures
from corpus_tools.config import SECTIONS
from corpus_tools.methods import METHODS
from corpus_tools.methods.fragments import JOIN_COMPONENTS, LIP_COMPONENTS, ROUNDS
from corpus_tools.methods.settings import Within
from corpus_tools.synthesis import align_fragments, blend_pieces, select_greedy, select_viterbi

FIT = {name: METHODS[name].fit for name in ("greedy", "viterbi")}
RENAMED = {
    ("cleaning", "head_iterations"): "iterations",
    ("alignment", "shape_c"): "c",
    ("closure", "project"): "closure",
}
SAME = [
    (clean_captures, "cleaning", 10),
    (select_greedy, "selection", 12),
    (select_viterbi, "selection", 13),
    (align_fragments, "alignment", 4),
    (blend_pieces, "blend", 9),
    (FIT["greedy"], "blend", 4),
    (FIT["viterbi"], "blend", 4),
    (FIT["greedy"], "selection", 4),
    (FIT["viterbi"], "selection", 10),
    *[(fit, section, 1) for fit in FIT.values() for section in ("cleaning", "closure")],
]


def shared(function, section):
    """Return (key, default of the config, default of the function) of what both have."""
    parameters = inspect.signature(function).parameters
    for key, field in SECTIONS[section].model_fields.items():
        name = RENAMED.get((section, key), key)
        if name in parameters:
            yield key, field.default, parameters[name].default


@pytest.mark.parametrize(("function", "section", "count"), SAME)
def test_defaults_are_those_of_the_config(function, section, count):
    found = list(shared(function, section))
    assert len(found) == count, [key for key, _, _ in found]
    for key, of_config, of_function in found:
        assert of_config == of_function, f"{section}.{key}"


def test_constants_of_the_methods_are_those_of_the_config():
    fields = SECTIONS["closure"].model_fields
    assert (fields["components"].default, fields["iterations"].default) == (LIP_COMPONENTS, ROUNDS)
    assert SECTIONS["selection"].model_fields["components"].default == JOIN_COMPONENTS


@pytest.mark.parametrize("method", METHODS)
def test_what_a_method_takes_the_config_takes_too(method):
    for key, kind in METHODS[method].kinds.items():
        bounds = next((b for b in getattr(kind, "__metadata__", ()) if isinstance(b, Within)), None)
        for name in ("selection", "blend"):
            if bounds and key in SECTIONS[name].model_fields:
                for value in (bounds.low, bounds.high):
                    SECTIONS[name].model_validate({key: value})
