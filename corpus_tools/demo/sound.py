"""A modest simulated voice: pulses and noise shaped by formants, in time with the phones."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.signal import istft, stft

from corpus_tools.core import Audio, FloatArray, Tier
from corpus_tools.demo.sentences import load_data

__all__ = ["RATE_HZ", "speak"]

RATE_HZ = 16000
_WINDOW = 320
_HOP = 80
_BANDWIDTH_HZ = (80.0, 100.0, 140.0)


def _resonances(formants: FloatArray, frequency: FloatArray) -> FloatArray:
    """Return the gain of cascaded resonators, (n_frequencies, n_frames), peak 1 in every frame."""
    gain = np.ones((len(frequency), len(formants)))
    for k, width in enumerate(_BANDWIDTH_HZ):
        centre = formants[:, k][None]
        f = frequency[:, None]
        gain *= centre**2 / np.sqrt((centre**2 - f**2) ** 2 + (width * f) ** 2)
    return np.asarray(gain / gain.max(axis=0, keepdims=True))


def _band(low: float, high: float, frequency: FloatArray) -> FloatArray:
    rise = np.clip((frequency - low) / 400 + 0.5, 0, 1)
    fall = np.clip((high - frequency) / 400 + 0.5, 0, 1)
    return np.asarray(rise * fall)


def _tracks(
    phones: Tier, times: FloatArray, frequency: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return formants (n, 3), voicing gain (n,) and noise gain (n_frequencies, n)."""
    table: dict[str, dict[str, Any]] = load_data("gestures")["sound"]
    voiced, noise = np.zeros(len(times)), np.zeros((len(frequency), len(times)))
    knots_t, knots_f = [], []
    for phone in phones:
        entry = table.get(phone.text, {})
        inside = (times >= phone.start_s) & (times < phone.end_s)
        gain = float(entry.get("gain", 1.0))
        if "formants" in entry:
            knots_t.append(phone.centre_s)
            knots_f.append(entry["formants"])
            voiced[inside] = gain
        if "noise" in entry:
            release = phone.start_s + 0.6 * phone.duration_s
            when = inside & (times >= release) if entry.get("stop") else inside
            low, high = entry["noise"]
            noise[:, when] = gain * _band(low, high, frequency)[:, None]
    formants = np.stack([np.interp(times, knots_t, np.array(knots_f, float)[:, k]) for k in range(3)], axis=1)
    kernel = np.hanning(7) / np.hanning(7).sum()
    return formants, np.convolve(voiced, kernel, "same"), noise


def speak(phones: Tier, rng: np.random.Generator) -> Audio:
    """Return a simulated voice that says timed phones: one hears rhythm, vowels and hisses, in time.

    Parameters
    ----------
    phones : Tier
    rng : numpy Generator
    """
    n = round(phones.intervals[-1].end_s * RATE_HZ)
    clock = np.arange(n) / n
    pitch_hz = 118.0 - 26.0 * clock + 3.0 * np.sin(2 * np.pi * 1.7 * clock)
    phase = np.cumsum(pitch_hz) / RATE_HZ
    pulses = np.diff(np.floor(phase), prepend=0.0) * 6.0
    pulses = np.convolve(pulses, np.exp(-np.arange(60) / 9.0), "full")[:n]
    hiss = rng.normal(0.0, 1.0, n)
    frequency, times, voiced_spectrum = stft(pulses, RATE_HZ, nperseg=_WINDOW, noverlap=_WINDOW - _HOP)
    _, _, noise_spectrum = stft(hiss, RATE_HZ, nperseg=_WINDOW, noverlap=_WINDOW - _HOP)
    formants, voiced, noise = _tracks(phones, times, frequency)
    shaped = voiced_spectrum * _resonances(formants, frequency) * voiced + 0.35 * noise_spectrum * noise
    _, wave = istft(shaped, RATE_HZ, nperseg=_WINDOW, noverlap=_WINDOW - _HOP)
    wave = np.resize(wave, n) if len(wave) < n else wave[:n]
    return Audio((0.7 * wave / max(float(np.abs(wave).max()), 1e-9)).astype(np.float32), RATE_HZ)
