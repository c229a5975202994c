"""What speech sounds like at a time, in a few numbers: to tell whether two sounds can be joined there."""

from __future__ import annotations

import functools

import numpy as np
import numpy.typing as npt
from scipy.fft import dct

from corpus_tools.core import Audio, FloatArray

__all__ = ["SOUND_FEATURES", "sound_features"]

WINDOW_S = 0.032
"""Length of the windows, s: at least two periods of a low voice."""

N_BANDS, N_CEPSTRA = 24, 12
LOWEST_HZ, HIGHEST_HZ = 80.0, 7600.0
PITCH_HZ = (70.0, 400.0)

SOUND_FEATURES = N_CEPSTRA + 3
"""Numbers per time: cepstra, log energy, voicing (0 to 1), octaves of pitch times voicing."""

QUIET = 1e-9
"""Power of what counts as silence: just above the rounding of 16-bit samples."""

NEARLY = 0.9
"""Share of the best autocorrelation from which a shorter period is taken: its multiples fit as well."""


def sound_features(audio: Audio, times_s: npt.ArrayLike) -> FloatArray:
    """Measure a sound at given times.

    Mel cepstra tell the shape of the spectrum (Davis & Mermelstein 1980), with energy and pitch: what unit
    selection for speech joins by (Hunt & Black 1996).

    Parameters
    ----------
    audio : Audio
    times_s : (n,) s
        Centres of the windows; beyond the ends there is silence.

    Returns
    -------
    (n, SOUND_FEATURES) float64
        Not scaled: their units differ.
    """
    rate, centres = audio.rate_hz, np.asarray(times_s, float)
    size = round(WINDOW_S * rate)
    padded = np.pad(np.asarray(audio.samples, float), size)
    first = np.clip(np.round(centres * rate).astype(int) + size - size // 2, 0, len(padded) - size)
    frames = padded[first[:, None] + np.arange(size)]
    power = np.abs(np.fft.rfft(frames * np.hanning(size), axis=1)) ** 2 / size
    bands = np.log(power @ _mel_bands(size, rate).T + QUIET)
    cepstra = dct(bands, type=2, norm="ortho", axis=1)[:, 1 : N_CEPSTRA + 1]
    energy = np.log(power.mean(axis=1) + QUIET)
    voicing, octaves = _pitch(frames, rate)
    return np.column_stack([cepstra, energy, voicing, octaves * voicing])


@functools.lru_cache(maxsize=8)
def _mel_bands(size: int, rate_hz: int) -> FloatArray:
    """Return triangles evenly spaced on the mel scale, (N_BANDS, n_frequencies)."""
    hz = np.fft.rfftfreq(size, 1.0 / rate_hz)

    def mel(f: npt.ArrayLike) -> FloatArray:
        return np.asarray(2595.0 * np.log10(1.0 + np.asarray(f, float) / 700.0))

    edges = np.linspace(mel(LOWEST_HZ), mel(min(HIGHEST_HZ, 0.5 * rate_hz)), N_BANDS + 2)
    width = edges[1] - edges[0]
    return np.asarray(np.maximum(0.0, 1.0 - np.abs(mel(hz)[None] - edges[1:-1, None]) / width))


def _pitch(frames: FloatArray, rate_hz: int) -> tuple[FloatArray, FloatArray]:
    """Return voicing (0 to 1) and octaves above the lowest pitch, by autocorrelation, (n,) each."""
    size = frames.shape[1]
    spectrum = np.fft.rfft(frames - frames.mean(axis=1, keepdims=True), 2 * size, axis=1)
    auto = np.fft.irfft(np.abs(spectrum) ** 2, axis=1)[:, :size]
    lags = np.arange(max(2, int(rate_hz / PITCH_HZ[1])), min(size - 2, int(rate_hz / PITCH_HZ[0])) + 1)
    fair = auto[:, lags] * (size / (size - lags))  # longer lags have fewer samples under them
    peaks = np.ones(fair.shape, bool)
    peaks[:, 1:] &= fair[:, 1:] >= fair[:, :-1]
    peaks[:, :-1] &= fair[:, :-1] >= fair[:, 1:]
    best = (peaks & (fair >= NEARLY * fair.max(axis=1, keepdims=True))).argmax(axis=1)
    voiced = fair[np.arange(len(fair)), best] / (auto[:, 0] + QUIET * size)
    return np.clip(voiced, 0.0, 1.0), np.log2(rate_hz / lags[best] / PITCH_HZ[0])
