"""The transport: sound, clock and overview of one utterance, master of the session's clock in the browser."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt
import panel as pn
import param

from corpus_tools.core import Audio, Utterance
from corpus_tools.speech import PhoneSet
from workbench.state import THEMES, phone_rows
from workbench.views.esm import esm
from workbench.views.theme import FRONTEND, palettes, style_sheet

__all__ = ["Transport", "pcm16"]


def pcm16(samples: npt.ArrayLike) -> bytes:
    """Return sound in [-1, 1] as 16-bit little-endian samples; what lies outside is clipped."""
    scaled = np.rint(np.asarray(samples, float) * 32768.0)
    return np.clip(scaled, -32768, 32767).astype("<i2").tobytes()


class Transport(pn.custom.JSComponent):
    """Play, pause, loop, speed, clock, and the overview on which a drag seeks.

    The sound is played by the browser with sample-exact ends, and its hardware time moves every view of the
    same `session` in the same animation frame; nothing is sent to the server while it plays. `time` is set
    when the clock has come to rest.

    Parameters
    ----------
    session : str
        Id of the clock.
    theme : "light" or "dark"
    keys_everywhere : bool
        Space plays wherever the focus is (unless something there needs the key); False: only inside.
    """

    loaded = param.Dict(
        default={},
        doc="""The utterance, as one value: parts would reach the browser one after the other. n: counts the
        utterances; pcm: 16-bit mono samples; duration_s: length of the motion, sound may be longer;
        phones: [start_s, end_s, phone, display class] in order; plays: play it as soon as it is there.""",
    )
    time = param.Number(default=0.0, doc="Where the clock came to rest, s.")
    session = param.String(default="default")
    theme = param.Selector(default="light", objects=list(THEMES))
    palettes = param.Dict(default={})
    keys_everywhere = param.Boolean(default=True)

    _esm = esm("transport", "renderTransport")
    _stylesheets: ClassVar[list[Any]] = [
        style_sheet(),
        (FRONTEND / "transport.css").read_text(encoding="utf-8"),
    ]

    def __init__(self, **params: Any) -> None:
        sizes = {} if "height" in params else {"height": 48}
        super().__init__(**{"sizing_mode": "stretch_width", "palettes": palettes(), **sizes, **params})

    def load(self, utterance: Utterance, phones: PhoneSet, plays: bool = False) -> None:
        """Take the sound, the length and the phones of an utterance; without sound it plays silence."""
        self.load_sound(utterance.audio, utterance.duration_s, phone_rows(utterance, phones), plays)

    def load_sound(
        self,
        audio: Audio | None,
        duration_s: float,
        rows: list[list[Any]] | None = None,
        plays: bool = False,
    ) -> None:
        """Take a sound, the length of what moves with it (s), and rows of its phones; play it when asked."""
        self.loaded = {
            "n": self.loaded.get("n", 0) + 1,
            "pcm": b"" if audio is None else pcm16(audio.samples),
            "rate_hz": 16000 if audio is None else int(audio.rate_hz),
            "duration_s": float(duration_s),
            "phones": rows or [],
            "plays": plays,
        }

    def play(self, from_s: float = 0.0, to_s: float | None = None) -> None:
        """Play a stretch; a browser allows sound only after the person has touched the page."""
        self._send_msg({"op": "play", "from": from_s, "to": 1e9 if to_s is None else to_s})

    def hear(self, sound: Audio) -> None:
        """Play another sound once; the clock stands still."""
        self._send_msg({"op": "hear", "pcm": pcm16(sound.samples), "rate": int(sound.rate_hz)})

    def seek(self, time_s: float) -> None:
        """Put the clock at a time."""
        self._send_msg({"op": "seek", "t": time_s})

    def stop(self) -> None:
        """Stop where the clock is."""
        self._send_msg({"op": "stop"})
