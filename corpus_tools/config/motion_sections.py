"""From fragments to a moving head: alignment, blend, closure, rest, retarget, deformation, output, film."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from corpus_tools.config.section import Section, section
from corpus_tools.core import InputError
from corpus_tools.synthesis import DEFAULT_CURVE, parse_weighting_at

__all__ = [
    "AlignmentSettings",
    "BlendSettings",
    "ClosureSettings",
    "DeformSettings",
    "FilmSettings",
    "OutputSettings",
    "RestSettings",
    "RetargetSettings",
]


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
    weighting_at: tuple[Annotated[str, Field(max_length=80)], ...] = Field(
        (),
        max_length=200,
        description="Joins with a g(u) of their own: 'where=name' or 'where=name:shape', where a class of "
        "phones, a phone or the number of a join stands first: 'bilabial=septic', '4=linear:-0.3'.",
    )
    rule: Literal["shared-phone", "paper"] = Field("shared-phone", description="What limits the overlap.")
    overlap_s: float = Field(0.12, ge=0, le=0.5, description="Longest overlap, s.")
    fraction: float = Field(
        0.5, gt=0, le=1, description="Rule 'paper': share of the smallest phone interval."
    )
    inertial_s: float = Field(
        0.12, gt=0, le=0.3, description="Mode 'inertial': time in which the offset dies away on a side, s."
    )

    @field_validator("weighting_at")
    @classmethod
    def _exceptions(cls, texts: tuple[str, ...]) -> tuple[str, ...]:
        for text in texts:
            try:
                parse_weighting_at(text)
            except InputError as error:
                raise ValueError(str(error).rstrip(".")) from None
        return texts

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
    smoothing: Annotated[float, Field(ge=0)] | Literal["auto"] = Field(
        1e-2, description="Smoothing of the warp, in a unit box; auto: what misses left-out landmarks least."
    )
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
