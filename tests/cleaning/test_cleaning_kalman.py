"""The smoother against the exact solution of its own model, and the laws that follow from the model."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.cleaning import kalman_smooth, measurement_sd_mm, smooth_channels
from corpus_tools.cleaning.kalman import DOUBTFUL_GAP_S
from corpus_tools.core import Capture, FrameFlag, MotionError

NAMES = ("brow0", "chin0", "cheek0")
FILLED, MEASURED = int(FrameFlag.FILLED), int(FrameFlag.MEASURED)
DOUBTFUL = FILLED | int(FrameFlag.DOUBTFUL)


def exact(values, seen, rate_hz, cutoff_hz):
    """Solve the model in one piece: all states at once, by whitened least squares in SI time units."""
    n, dt, omega = len(values), 1.0 / rate_hz, 2 * np.pi * cutoff_hz
    move = np.array([[1, dt, dt**2 / 2], [0, 1, dt], [0, 0, 1]])
    q = omega**6 * dt
    noise = q * np.array(
        [
            [dt**5 / 20, dt**4 / 8, dt**3 / 6],
            [dt**4 / 8, dt**3 / 3, dt**2 / 2],
            [dt**3 / 6, dt**2 / 2, dt],
        ]
    )
    units = np.diag([1.0, 1 / omega, 1 / omega**2])  # unknowns of one size
    white = np.linalg.inv(np.linalg.cholesky(units @ noise @ units)) @ units
    back = np.linalg.inv(units)
    rows, right = [], []
    for k in range(n - 1):
        block = np.zeros((3, 3 * n))
        block[:, 3 * k : 3 * k + 3] = -white @ move @ back
        block[:, 3 * k + 3 : 3 * k + 6] = white @ back
        rows.append(block)
        right.append(np.zeros((3, values.shape[1])))
    for k in np.flatnonzero(seen):
        block = np.zeros((1, 3 * n))
        block[0, 3 * k] = 1.0
        rows.append(block)
        right.append(values[k : k + 1])
    start = np.zeros((3, 3 * n))
    start[:, :3] = 1e-4 * np.eye(3)
    rows.append(start)
    at_rest = np.zeros((3, values.shape[1]))
    at_rest[0] = 1e-4 * values[np.argmax(seen)]
    right.append(at_rest)
    whole = np.concatenate(rows)
    orthogonal, upper = np.linalg.qr(whole)
    states = np.linalg.solve(upper, orthogonal.T @ np.concatenate(right))
    inverse = np.linalg.inv(upper)
    return states[::3], (inverse**2).sum(1)[::3]


@pytest.mark.parametrize("rate_hz", [25.0, 120.0])
@pytest.mark.parametrize("missing", [[], [(30, 37)], [(0, 4), (50, 52), (60, 62)], [(70, 79)]])
def test_it_is_the_exact_solution_of_the_model(rate_hz, missing):
    values = np.random.default_rng(2).normal(size=(80, 4))
    seen = np.ones(80, bool)
    for a, b in missing:
        seen[a : b + 1] = False
    smoothed, variance = smooth_channels(values, seen, rate_hz, 10.0)
    wanted, wanted_variance = exact(values, seen, rate_hz, 10.0)
    inside = slice(int(np.argmax(seen)), 80 - int(np.argmax(seen[::-1])))
    assert np.abs(smoothed - wanted)[inside].max() < 1e-8
    assert np.abs(smoothed - wanted).max() < 1e-6 * max(1.0, np.abs(wanted).max())
    assert variance[inside] == pytest.approx(wanted_variance[inside], rel=1e-6)


def step_by_step(values, seen, rate_hz, cutoff_hz):
    """Filter and smooth one channel as the textbook has it, every covariance anew in every frame."""
    from corpus_tools.cleaning.kalman import process_noise

    move = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]])
    noise, omega = process_noise(rate_hz, cutoff_hz), 2 * np.pi * cutoff_hz / rate_hz
    x, p = np.array([values[np.argmax(seen)], 0, 0]), 1e8 * np.diag([1, omega**2, omega**4])
    kept = []
    for k, value in enumerate(values):
        if k:
            x, p = move @ x, move @ p @ move.T + noise
        ahead = (x, p)
        if seen[k]:
            gain = p[:, 0] / (p[0, 0] + 1)
            keep = np.eye(3) - np.outer(gain, [1, 0, 0])
            x, p = x + gain * (value - x[0]), keep @ p @ keep.T + np.outer(gain, gain)
        kept.append((*ahead, x, p))
    out, spread = [x[0]], [p[0, 0]]
    for k in range(len(values) - 2, -1, -1):
        x_ahead, p_ahead = kept[k + 1][:2]
        x_here, p_here = kept[k][2:]
        back = p_here @ move.T @ np.linalg.inv(p_ahead)
        x, p = x_here + back @ (x - x_ahead), p_here + back @ (p - p_ahead) @ back.T
        out.append(x[0])
        spread.append(p[0, 0])
    return np.array(out[::-1]), np.array(spread[::-1])


@given(st.integers(0, 10_000), st.sampled_from([25.0, 120.0, 200.0]), st.sampled_from([4.0, 10.0]))
def test_gains_that_are_reused_equal_gains_made_anew(seed, rate_hz, cutoff_hz):
    random = np.random.default_rng(seed)
    values, seen = random.normal(size=500).cumsum(), np.ones(500, bool)
    for start in random.integers(5, 470, random.integers(0, 5)):
        seen[start : start + random.integers(1, 12)] = False
    smoothed, variance = smooth_channels(values[:, None], seen, rate_hz, cutoff_hz)
    wanted, wanted_variance = step_by_step(values, seen, rate_hz, cutoff_hz)
    assert np.abs(smoothed[:, 0] - wanted).max() < 1e-9 * np.abs(values).max()
    assert variance == pytest.approx(wanted_variance, rel=1e-6)


def capture_of(positions, rate_hz=120.0):
    return Capture(positions, rate_hz, NAMES[: positions.shape[1]])


@given(*[st.floats(-40, 40)] * 3, st.sampled_from([None, (20, 27), (60, 71)]))
def test_a_marker_that_accelerates_evenly_is_left_alone_and_bridged(a, b, c, gap):
    times = np.arange(100) / 120.0
    positions = np.broadcast_to((a + b * times + c * times**2)[:, None, None], (100, 2, 3)).copy()
    truth = positions.copy()
    if gap:
        positions[gap[0] : gap[1] + 1, 0] = np.nan
    smoothed, _ = kalman_smooth(capture_of(positions))
    assert np.abs(smoothed.positions_mm - truth).max() < 1e-5


@given(st.integers(0, 1000))
def test_time_may_run_backwards(seed):
    random = np.random.default_rng(seed)
    positions = random.normal(size=(90, 2, 3)).cumsum(0)
    positions[40:46, 1] = np.nan
    forth = kalman_smooth(capture_of(positions))[0].positions_mm
    back = kalman_smooth(capture_of(positions[::-1]))[0].positions_mm[::-1]
    assert np.abs(forth - back).max() < 1e-5


@given(st.integers(0, 1000), st.floats(-5, 5), st.floats(-100, 100))
def test_smoothing_is_linear(seed, factor, shift):
    positions = np.random.default_rng(seed).normal(size=(60, 1, 3))
    one = kalman_smooth(capture_of(positions))[0].positions_mm
    other = kalman_smooth(capture_of(factor * positions + shift))[0].positions_mm
    assert np.abs(other - (factor * one + shift)).max() < 1e-6


def band_limited(seed, n=4000, rate_hz=120.0, top_hz=6.0):
    """Return simulated motion (n, 3, 3) with nothing above `top_hz`, sd 2 mm."""
    spectrum = np.fft.rfft(np.random.default_rng(seed).normal(size=(n, 3, 3)), axis=0)
    spectrum[np.fft.rfftfreq(n, 1 / rate_hz) > top_hz] = 0
    motion = np.fft.irfft(spectrum, n, axis=0)
    return 2.0 * motion / motion.std()


def test_noise_on_slow_motion_falls_by_5_db():
    truth = band_limited(3)
    noisy = truth + np.random.default_rng(4).normal(scale=0.15, size=truth.shape)
    smoothed = kalman_smooth(capture_of(noisy))[0].positions_mm
    gain_db = 20 * np.log10((noisy - truth).std() / (smoothed - truth).std())
    assert gain_db > 5.0  # 7 dB


def test_the_cutoff_is_the_frequency_that_is_halved():
    times = np.arange(2400) / 120.0
    for frequency, least, most in [(2.0, 0.99, 1.01), (10.0, 0.48, 0.52), (25.0, 0.0, 0.01)]:
        wave = np.sin(2 * np.pi * frequency * times)[:, None]
        smoothed, _ = smooth_channels(wave, np.ones(2400, bool), 120.0, 10.0)
        middle = slice(600, 1800)
        share = (smoothed[middle] * wave[middle]).sum() / (wave[middle] ** 2).sum()
        assert least <= share <= most


@given(st.floats(0.02, 2.0), st.integers(0, 1000))
def test_the_noise_of_each_channel_is_found(sd, seed):
    random = np.random.default_rng(seed)
    scales = sd * np.array([1.0, 2.0, 4.0])
    positions = random.normal(size=(3000, 1, 3)) * scales + 10 * np.sin(np.arange(3000) / 120)[:, None, None]
    assert measurement_sd_mm(positions)[0] == pytest.approx(scales, rel=0.12)


def test_the_noise_of_nearly_nothing_is_zero():
    assert not measurement_sd_mm(np.ones((3, 2, 3))).any()
    lost = np.ones((20, 2, 3))
    lost[:, 1] = np.nan
    assert not measurement_sd_mm(lost).any()


def test_the_stated_uncertainty_is_that_of_the_model():
    """Over many runs of the model itself, two thirds of the errors lie within one standard deviation."""
    from corpus_tools.cleaning.kalman import process_noise

    random, n, channels = np.random.default_rng(5), 200, 400
    root = np.linalg.cholesky(process_noise(120.0, 10.0))
    move = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]])
    state, path = np.zeros((3, channels)), []
    for _ in range(n):
        path.append(state[0])
        state = move @ state + root @ random.normal(size=(3, channels))
    truth, seen = np.array(path), np.ones(n, bool)
    seen[90:100] = False
    smoothed, variance = smooth_channels(truth + random.normal(size=truth.shape), seen, 120.0, 10.0)
    ratio = (smoothed - truth).std(axis=1) / np.sqrt(variance)
    assert ratio[5:-5].min() > 0.8
    assert ratio[5:-5].max() < 1.2
    assert variance[95] > 3 * variance[50]


def gappy(gap, n=120, rate_hz=120.0):
    positions = band_limited(6, n)
    positions[gap[0] : gap[1] + 1, 1] = np.nan
    return capture_of(positions, rate_hz)


def test_a_short_gap_is_bridged_and_flagged_filled():
    smoothed, sd_mm = kalman_smooth(gappy((50, 55)))
    assert np.isfinite(smoothed.positions_mm).all()
    assert (smoothed.flags[50:56, 1] == FILLED).all()
    rest = np.ones_like(smoothed.flags, bool)
    rest[50:56, 1] = False
    assert (smoothed.flags[rest] == MEASURED).all()
    assert sd_mm[52, 1, 0] > 1.5 * sd_mm[20, 1, 0]
    assert sd_mm[52, 0, 0] == pytest.approx(sd_mm[60, 0, 0], rel=1e-3)
    truth = band_limited(6, 120)
    assert np.sqrt(((smoothed.positions_mm - truth)[50:56, 1] ** 2).mean()) < 0.5


@pytest.mark.parametrize("gap", [(0, 3), (116, 119), (40, 40 + int(DOUBTFUL_GAP_S * 120))])
def test_gaps_at_an_end_and_long_ones_are_doubtful(gap):
    smoothed, _ = kalman_smooth(gappy(gap))
    assert (smoothed.flags[gap[0] : gap[1] + 1, 1] == DOUBTFUL).all()
    assert np.isfinite(smoothed.positions_mm).all()


def test_the_longest_gap_that_is_trusted():
    long = int(DOUBTFUL_GAP_S * 120)
    smoothed, _ = kalman_smooth(gappy((40, 40 + long - 1)))
    assert (smoothed.flags[40 : 40 + long, 1] == FILLED).all()


def test_a_gap_at_an_end_holds_the_nearest_pose():
    first = kalman_smooth(gappy((0, 9)))[0].positions_mm
    assert (first[:10, 1] == first[10, 1]).all()
    last = kalman_smooth(gappy((110, 119)))[0].positions_mm
    assert (last[110:, 1] == last[109, 1]).all()


def test_a_marker_that_is_never_seen_stays_put_and_doubtful():
    positions = np.ones((30, 3, 3)) * np.array([0.0, np.nan, 4.0])[None, :, None]
    smoothed, _ = kalman_smooth(capture_of(positions))
    assert (smoothed.positions_mm[:, 1] == 2.0).all()
    assert (smoothed.flags[:, 1] == DOUBTFUL).all()


def test_what_was_doubtful_before_stays_so():
    capture = gappy((50, 55))
    flags = np.array(capture.flags)
    flags[48:60] |= np.uint8(FrameFlag.DOUBTFUL)
    smoothed, _ = kalman_smooth(Capture(capture.positions_mm, 120.0, NAMES, flags=flags))
    assert (smoothed.flags[50:56, 1] == DOUBTFUL).all()
    assert (smoothed.flags[48:60, 0] == MEASURED | int(FrameFlag.DOUBTFUL)).all()


def test_a_capture_that_shows_nothing_is_refused():
    with pytest.raises(MotionError, match="no marker in any frame"):
        kalman_smooth(capture_of(np.full((5, 1, 3), np.nan)))


def test_short_captures_and_slow_cameras_are_smoothed_too():
    for n in (1, 2, 3):
        assert kalman_smooth(capture_of(np.ones((n, 1, 3))))[0].positions_mm == pytest.approx(1.0)
    slow = kalman_smooth(capture_of(band_limited(7, 60), rate_hz=12.0))[0]
    assert dict(slow.history[-1].settings)["cutoff_hz"] == pytest.approx(0.45 * 12)


def test_the_given_noise_scales_the_uncertainty_only():
    capture = gappy((50, 55))
    one, one_sd = kalman_smooth(capture, measurement_sd=0.1)
    two, two_sd = kalman_smooth(capture, measurement_sd=0.2)
    assert (one.positions_mm == two.positions_mm).all()
    assert two_sd == pytest.approx(2 * one_sd)


def test_the_input_is_not_touched():
    capture = gappy((50, 55))
    before = np.array(capture.positions_mm)
    kalman_smooth(capture)
    assert np.array_equal(capture.positions_mm, before, equal_nan=True)


@pytest.mark.parametrize(("first", "last"), [(0, 800), (0, 300), (300, 900)])
def test_a_gap_of_half_a_minute_has_a_band_like_any_other(first, last):
    """There the variances are differences of numbers of 1e13."""
    seen = np.ones(1000, bool)
    seen[first:last] = False
    values = np.random.default_rng(0).normal(size=(1000, 3))
    smoothed, variance = smooth_channels(values, seen, 25.0, 10.0)
    assert np.isfinite(smoothed).all()
    assert variance.min() > 0
    assert variance[(first + last) // 2] > 1e6 * variance[-1]
