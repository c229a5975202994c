"""A small drawing of lines, texts and pictures that is written as SVG and as PNG alike."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass, field
from html import escape

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

__all__ = ["Drawing"]

FONTS = "Inter, 'Helvetica Neue', Arial, 'Liberation Sans', sans-serif"
ANCHORS = {"left": ("start", "l"), "middle": ("middle", "m"), "right": ("end", "r")}
FINER = 3
"""The PNG is drawn so much larger before it is reduced, so that thin lines are smooth."""


@dataclass(frozen=True, slots=True)
class _Line:
    points: npt.NDArray[np.float64]
    colour: str
    width: float
    dashed: bool


@dataclass(frozen=True, slots=True)
class _Text:
    x: float
    y: float
    text: str
    size: float
    colour: str
    anchor: str
    upright: bool


@dataclass(frozen=True, slots=True)
class _Picture:
    x: float
    y: float
    width: float
    height: float
    pixels: npt.NDArray[np.uint8]


@dataclass(slots=True)
class Drawing:
    """What is to be drawn, in order, on a white ground; the unit is a pixel, y goes down.

    Attributes
    ----------
    width, height : float
    title : str
        What it shows, for readers that cannot see it.
    """

    width: float
    height: float
    title: str = ""
    shapes: list[_Line | _Text | _Picture] = field(default_factory=list)

    def line(
        self, points: npt.ArrayLike, colour: str = "#222222", width: float = 1.0, dashed: bool = False
    ) -> None:
        """Add a line through points (n, 2)."""
        self.shapes.append(_Line(np.asarray(points, float).reshape(-1, 2), colour, width, dashed))

    def text(
        self,
        x: float,
        y: float,
        text: str,
        size: float = 13.0,
        colour: str = "#222222",
        anchor: str = "middle",
        upright: bool = False,
    ) -> None:
        """Add a text whose middle height is at y; `upright` turns it to be read from the right."""
        self.shapes.append(_Text(x, y, text, size, colour, anchor, upright))

    def picture(self, x: float, y: float, width: float, height: float, pixels: npt.NDArray[np.uint8]) -> None:
        """Add a picture (rows, columns, 3), stretched to a width and a height."""
        self.shapes.append(_Picture(x, y, width, height, pixels))

    def svg(self) -> str:
        """Return the drawing as SVG; pictures are inside it."""
        body = "\n".join(_svg(shape) for shape in self.shapes)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width:g}" height="{self.height:g}" '
            f'viewBox="0 0 {self.width:g} {self.height:g}" role="img" font-family="{escape(FONTS)}">\n'
            f"<title>{escape(self.title)}</title>\n"
            f'<rect width="100%" height="100%" fill="#ffffff"/>\n{body}\n</svg>\n'
        )

    def png(self, scale: int = 2) -> bytes:
        """Return the drawing as PNG, `scale` pixels for each of the drawing's."""
        factor = scale * FINER
        size = (round(self.width * factor), round(self.height * factor))
        image = Image.new("RGB", size, "#ffffff")
        draw = ImageDraw.Draw(image)
        for shape in self.shapes:
            if isinstance(shape, _Line):
                _draw_line(draw, shape, factor)
            elif isinstance(shape, _Text):
                _draw_text(image, shape, factor)
            else:
                there = (round(shape.width * factor), round(shape.height * factor))
                small = Image.fromarray(shape.pixels).resize(there, Image.Resampling.LANCZOS)
                image.paste(small, (round(shape.x * factor), round(shape.y * factor)))
        stream = io.BytesIO()
        image.reduce(FINER).save(stream, format="PNG")
        return stream.getvalue()


def _svg(shape: _Line | _Text | _Picture) -> str:
    if isinstance(shape, _Line):
        points = " ".join(f"{x:.2f},{y:.2f}" for x, y in shape.points)
        dashes = ' stroke-dasharray="4 3"' if shape.dashed else ""
        return (
            f'<polyline points="{points}" fill="none" stroke="{shape.colour}" stroke-width="{shape.width:g}" '
            f'stroke-linejoin="round" stroke-linecap="round"{dashes}/>'
        )
    if isinstance(shape, _Text):
        turn = f' transform="rotate(-90 {shape.x:.2f} {shape.y:.2f})"' if shape.upright else ""
        return (
            f'<text x="{shape.x:.2f}" y="{shape.y:.2f}" font-size="{shape.size:g}" fill="{shape.colour}" '
            f'text-anchor="{ANCHORS[shape.anchor][0]}" dominant-baseline="central"{turn}>'
            f"{escape(shape.text)}</text>"
        )
    stream = io.BytesIO()
    Image.fromarray(shape.pixels).save(stream, format="PNG")
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    return (
        f'<image x="{shape.x:.2f}" y="{shape.y:.2f}" width="{shape.width:.2f}" height="{shape.height:.2f}" '
        f'preserveAspectRatio="none" href="data:image/png;base64,{data}"/>'
    )


def _draw_line(draw: ImageDraw.ImageDraw, line: _Line, factor: float) -> None:
    width = max(1, round(line.width * factor))
    for piece in _dashes(line.points) if line.dashed else [line.points]:
        draw.line([(float(x), float(y)) for x, y in piece * factor], line.colour, width, joint="curve")


def _dashes(points: npt.NDArray[np.float64]) -> list[npt.NDArray[np.float64]]:
    """Return the pieces of a line that are drawn when it is dashed: 4 on, 3 off."""
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    starts = np.arange(0.0, length[-1], 7.0)
    ends = np.minimum(starts + 4.0, length[-1])
    return [
        np.array([[np.interp(at, length, points[:, k]) for k in (0, 1)] for at in (a, b)])
        for a, b in zip(starts, ends, strict=True)
    ]


def _draw_text(image: Image.Image, text: _Text, factor: float) -> None:
    font = ImageFont.load_default(text.size * factor)
    anchor = ANCHORS[text.anchor][1] + "m"
    place = (text.x * factor, text.y * factor)
    if not text.upright:
        ImageDraw.Draw(image).text(place, text.text, text.colour, font, anchor)
        return
    left, top, right, bottom = font.getbbox(text.text, anchor="lt")
    tile = Image.new("RGB", (round(right - left) + 4, round(bottom - top) + 4), "#ffffff")
    ImageDraw.Draw(tile).text((2, 2), text.text, text.colour, font, "lt")
    turned = tile.rotate(90, expand=True)
    image.paste(turned, (round(place[0] - turned.width / 2), round(place[1] - turned.height / 2)))
