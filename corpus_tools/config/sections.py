"""The sections of a config, one class each: every value that changes a result, with bounds and a sentence.

A new section is a class here (or in a module of its own) under ``@section("name")``; loading, export, the
diff, the schema and the command line pick it up from the registry.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal, TypeVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator

from corpus_tools.cleaning import check_gap_method
from corpus_tools.core import InputError, Registry
from corpus_tools.synthesis import DEFAULT_CURVE

__all__ = [
    "SECTIONS",
    "AlignmentSettings",
    "BlendSettings",
    "CleaningSettings",
    "ClosureSettings",
    "DeformSettings",
    "FilmSettings",
    "OutputSettings",
    "OverrideSettings",
    "RestSettings",
    "RetargetSettings",
    "Section",
    "SelectionSettings",
    "SpeechSettings",
    "section",
]


class Section(BaseModel):
    """Base of every section: unknown keys are refused, values are checked, instances do not change."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @field_validator("*", mode="before")
    @classmethod
    def _of_its_kind(cls, value: Any, info: ValidationInfo) -> Any:
        """Refuse texts and switches for numbers, and numbers for switches, which pydantic would turn over."""
        wanted = cls.model_fields[str(info.field_name)].annotation
        of_each = get_args(get_args(wanted)[0])[:1] if get_origin(wanted) is tuple else (wanted,)
        for one in value if get_origin(wanted) is tuple and isinstance(value, list | tuple) else [value]:
            if of_each[0] in (int, float) and isinstance(one, bool | str):
                raise ValueError("a number without quotes was expected")
            if of_each[0] is bool and not isinstance(one, bool):
                raise ValueError("true or false was expected, without quotes")
        return value


SECTIONS: Registry[type[Section]] = Registry("config section")

S = TypeVar("S", bound=type[Section])


def section(name: str) -> Callable[[S], S]:
    """Return a decorator that registers a section under `name`."""

    def enter(cls: S) -> S:
        SECTIONS.add(name, cls)
        return cls

    return enter


@section("speech")
class SpeechSettings(Section):
    """How text is spoken; recordings and label files bring their own sound and times."""

    engine: str = Field("espeak", description="Speech engine by name: espeak, the embedded voice.")
    language: str = Field(
        "", description="Such as en, en-gb, en-us; empty: the language that corpus.toml names."
    )
    voice: str = Field("", description="Variant of the voice, such as f2; empty: its usual one.")
    rate: float = Field(1.0, ge=0.5, le=2.5, description="Speaking rate: 1 as usual, 2 twice as fast.")


@section("cleaning")
class CleaningSettings(Section):
    """Paper A section 4: noise, gaps, head motion."""

    cutoff_hz: float = Field(10.0, ge=0.1, le=60, description="Kalman smoother: frequency kept, Hz.")
    noise: Literal["cutoff", "channels", "components"] = Field(
        "cutoff",
        description="Kalman smoother: one cutoff for all, or noise estimated by channel or by component.",
    )
    head_cutoff_mm: float = Field(
        1.0, ge=0.001, le=20, description="Residual at which a head marker is doubted, mm."
    )
    head_iterations: int = Field(6, ge=1, le=50, description="Reweighting rounds of the head-motion fit.")
    head_support: bool = Field(
        True, description="Let upper-face markers that hardly move help the head markers to find the head."
    )
    gap_method: str = Field(
        "auto",
        description="Gap filling: auto (per gap, the best in rehearsal), pca-gp, gp, dct (paper A), kalman.",
    )
    gap_longest_s: float = Field(1.0, gt=0, le=60, description="Longer gaps are filled but doubtful, s.")
    gap_doubt_mm: float = Field(
        1.0, gt=0, le=100, description="Uncertainty from which a filled sample is doubtful, mm."
    )
    gap_components: int = Field(24, ge=1, le=60, description="Principal components that fill gaps.")
    outliers: bool = Field(
        True, description="Take out spikes and exchanged markers, flag markers that slid (beyond the paper)."
    )
    remove_bias: bool = Field(
        True, description="Free each recording of the posture it keeps constantly (beyond the paper)."
    )

    @field_validator("gap_method")
    @classmethod
    def _known(cls, name: str) -> str:
        try:
            check_gap_method(name)
        except InputError as error:
            raise ValueError(str(error).rstrip(".")) from None
        return name


@section("selection")
class SelectionSettings(Section):
    """Paper A section 5.1.1: which fragments speak the utterance."""

    method: str = Field("viterbi", description="Method id: greedy (as printed, mended) or viterbi.")
    duration: float = Field(1.0, ge=0, le=1e6, description="Weight of the difference in phone timing.")
    context: float = Field(
        0.3, ge=0, le=1e6, description="Weight of the neighbours left and right of the unit."
    )
    backoff: float = Field(
        2.0, ge=0, le=1e6, description="Cost of a phone that its viseme class stands in for."
    )
    flagged: float = Field(
        1.0, ge=0, le=1e6, description="Weight of filled or doubtful frames inside the unit."
    )
    join: float = Field(1.0, ge=0, le=1e6, description="Weight of the posture distance at a join.")
    velocity: float = Field(
        0.3, ge=0, le=1e6, description="Weight of the velocity distance at a join, relative to join."
    )
    allow_backoff: bool = Field(True, description="Let a viseme class stand in where a diphone is missing.")
    components: int = Field(12, ge=1, le=60, description="Principal components of the join distance.")
    prune: int = Field(100, ge=1, description="Candidates kept per diphone by Viterbi.")


@section("overrides")
class OverrideSettings(Section):
    """A person's word against the search: what must and what must not be used."""

    pins: tuple[Annotated[str, Field(pattern=r"^\d+-\d+=.+:\d+-\d+$")], ...] = Field(
        (),
        description="Target phones and the unit that must speak them: 'first-last=recording:i-j'; a pin "
        "holds against a ban, and synth says so.",
    )
    bans: tuple[Annotated[str, Field(min_length=1)], ...] = Field(
        (), description="Units ('recording:i-j') or whole recordings that must not be used."
    )


@section("alignment")
class AlignmentSettings(Section):
    """Paper A section 5.1.2: time warp and resampling."""

    warp: Literal["linear", "pchip"] = Field("linear", description="Time map between labels.")
    resampling: Literal["inverse", "paper"] = Field(
        "inverse", description="Fit on the source clock, or on the warped samples as printed."
    )
    shape_c: float = Field(
        0.2, ge=0.12, le=1.0, description="Inverse multiquadric: eps = c / smallest spacing."
    )
    rate_hz: float = Field(120.0, gt=0, le=1000, description="Frame rate of the synthesised motion, Hz.")


@section("blend")
class BlendSettings(Section):
    """Paper A section 5.1.3, eq. (2): the overlap and its weighting function g(u)."""

    mode: Literal["crossfade", "inertial"] = Field(
        "crossfade",
        description="Blend by g(u) over an overlap, or (beyond the paper) let the offset of a join die away.",
    )
    weighting: str = Field("smootherstep", description="g(u), by name.")
    shape: float = Field(0.0, ge=-1, le=1, description="Moves the crossover of g(u): early -1 .. late +1.")
    curve_weights: tuple[Annotated[float, Field(ge=0, le=1e6)], ...] = Field(
        DEFAULT_CURVE,
        min_length=4,
        max_length=64,
        description="g(u) 'user': weights of its slope from first to last; two 0 at either end make it C2.",
    )
    rule: Literal["shared-phone", "paper"] = Field("shared-phone", description="What limits the overlap.")
    overlap_s: float = Field(0.12, ge=0, le=0.5, description="Longest overlap, s.")
    fraction: float = Field(
        0.5, gt=0, le=1, description="Rule 'paper': share of the smallest phone interval."
    )
    inertial_s: float = Field(
        0.12, gt=0, le=0.3, description="Mode 'inertial': time in which the offset dies away on a side, s."
    )

    @field_validator("curve_weights")
    @classmethod
    def _falls(cls, weights: tuple[float, ...]) -> tuple[float, ...]:
        if not any(weights):
            raise ValueError("all weights are 0, so that g(u) would not fall")
        return weights


@section("closure")
class ClosureSettings(Section):
    """Contacts of the lips after blending, p b m and f v; our own step, beyond paper A."""

    project: bool = Field(True, description="Close the lips where a bilabial stayed open.")
    components: int = Field(16, ge=1, le=60, description="Principal components that carry the correction.")
    iterations: int = Field(3, ge=1, le=20, description="Rounds of the projection.")
    on_teeth: bool = Field(True, description="Bring the lower lip to the teeth where an f or v stayed off.")
    hold_s: float = Field(
        0.042, ge=0, le=0.2, description="So long the lips stay closed, s, if the phone lasts; 0: they touch."
    )


@section("rest")
class RestSettings(Section):
    """The way from the neutral pose into speech and back; our own step, beyond paper A."""

    ease_s: float = Field(
        0.15,
        ge=0,
        le=2,
        description="Way from rest to the first phone and from the last one back, in silence, s; 0: none.",
    )


@section("retarget")
class RetargetSettings(Section):
    """Paper A section 6: the volume warp from the actor's neutral to the mesh."""

    kernel: str = Field("cubic", description="Radial kernel of the warp.")
    smoothing: float = Field(1e-2, ge=0, description="Smoothing of the warp, in a unit box.")
    contact: bool = Field(True, description="Keep the lips from passing through each other.")


@section("deform")
class DeformSettings(Section):
    """Paper A section 6: from markers to the vertices of a mesh."""

    mesh: str = Field("base", description="A bundled head by name, or a mesh file.")
    deformer: str = Field("bid", description="Deformer by name: bid, linear or rbf.")


@section("output")
class OutputSettings(Section):
    """What synth writes."""

    seed: int = Field(0, ge=0, description="Seed of everything random.")


@section("film")
class FilmSettings(Section):
    """Pictures of the head: the film, its frames, the strip of frames."""

    rate_hz: float = Field(30.0, ge=1, le=240, description="Pictures per second of the film.")
    width: int = Field(1280, ge=64, le=7680, multiple_of=2, description="Width, pixels.")
    height: int = Field(720, ge=64, le=4320, multiple_of=2, description="Height, pixels.")
    view: Literal["front", "three-quarter", "side"] = Field("front", description="Where the camera stands.")
    zoom_mm: float = Field(0.0, ge=0, le=500, description="Height shown around the mouth; 0: the face.")
    strip_frames: int = Field(6, ge=2, le=16, description="Poses in the strip of frames.")
