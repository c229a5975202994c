"""Paper A section 4, the end: noise, missing data and rigid head motion are removed from the capture.

On a simulated capture: a talking face at 120 Hz, markers with 0.15 mm of noise, a head that sways, a jig on
it that slips by 1.5 mm half way, and a marker that is hidden for a moment.
"""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from corpus_tools.cleaning import clean_captures, fill_gaps, kalman_smooth, remove_head_motion
from corpus_tools.core import Capture, FrameFlag

RATE_HZ, N, NOISE_MM = 120.0, 2400, 0.15
JIG, UPPER, MOUTH = range(0, 5), range(5, 23), range(23, 31)
NAMES = (
    *(f"head{i}" for i in range(5)),
    *(f"brow{i}" for i in range(10)),
    *(f"eye{i}" for i in range(8)),
    *(f"lip_in{i}" for i in range(8)),
)
SHAPE = np.concatenate(
    [
        [[-70, 120, 30], [70, 120, 30], [0, 160, 10], [-40, 140, 60], [40, 140, 60]],
        [[x, 65 - x * x / 200, 75 - x * x / 150] for x in np.linspace(-55, 55, 10)],
        [[x, 40 + 5 * (-1) ** i, 60 - abs(x) / 4] for i, x in enumerate(np.linspace(-50, 50, 8))],
        [[25 * np.cos(a), -30 + 6 * np.sin(a), 80] for a in np.arange(8) * np.pi / 4],
    ]
)


def slow(random, shape, top_hz, sd):
    """Return (N, *shape) noise with nothing above `top_hz` and the given spread."""
    spectrum = np.fft.rfft(random.normal(size=(N, *shape)), axis=0)
    spectrum[np.fft.rfftfreq(N, 1 / RATE_HZ) > top_hz] = 0
    made = np.fft.irfft(spectrum, N, axis=0)
    return sd * made / made.std()


def simulate(slip_mm=1.5):
    """Return the true face (N, 31, 3) and what is captured of it."""
    random = np.random.default_rng(11)
    face = np.repeat(SHAPE[None], N, axis=0)
    face[:, MOUTH] += slow(random, (8, 3), 6.0, 2.0)
    face[:, UPPER] += slow(random, (18, 3), 3.0, 0.25)  # skin is not bone
    seen = face.copy()
    seen[N // 2 :, JIG] += slip_mm / 1.5 * np.array([1.0, -1.0, 0.5])
    turns = Rotation.from_rotvec(slow(random, (3,), 1.0, 0.08)).as_matrix()
    seen = seen @ turns + slow(random, (3,), 1.0, 15.0)[:, None]
    seen = seen + random.normal(scale=NOISE_MM, size=seen.shape)
    return face, seen


@pytest.fixture(scope="module")
def simulated():
    return simulate()


def mouth_error_mm(stable, face):
    """Return the 3-D rms at the mouth in both halves, from the mean place of the first half."""
    error = (stable - face)[:, MOUTH]
    error = error - error[: N // 2].mean(axis=(0, 1))
    halves = error[: N // 2], error[N // 2 :]
    return [float(np.sqrt((half**2).sum(axis=2).mean())) for half in halves]


def test_kalman_filtering_removes_noise():
    random = np.random.default_rng(12)
    truth = slow(random, (31, 3), 6.0, 1.8)  # 21.6 dB above the noise
    noisy = Capture(truth + random.normal(scale=NOISE_MM, size=truth.shape), RATE_HZ, NAMES)
    smoothed, sd_mm = kalman_smooth(noisy)
    before, after = (noisy.positions_mm - truth).std(), (smoothed.positions_mm - truth).std()
    assert 20 * np.log10(truth.std() / before) == pytest.approx(21.6, abs=0.2)
    assert 20 * np.log10(before / after) > 6.0
    assert np.median(sd_mm) == pytest.approx(after, rel=0.35)


def test_resampling_of_the_cosine_transform_reconstructs_missing_data():
    """As printed, without any other marker: 0.2 s of a moving mouth, against a cubic."""
    random = np.random.default_rng(13)
    truth = slow(random, (31, 3), 6.0, 1.8)
    seen = truth + random.normal(scale=0.03, size=truth.shape)
    gaps = [(300 + 250 * k, 323 + 250 * k, 3 * k) for k in range(8)]
    hidden = seen.copy()
    for first, last, marker in gaps:
        hidden[first : last + 1, marker] = np.nan
    filled, sd_mm = fill_gaps(Capture(hidden, RATE_HZ, NAMES), "dct")
    errors = []
    for first, last, marker in gaps:
        gap, keep = np.arange(first, last + 1), np.setdiff1d(np.arange(N), np.arange(first, last + 1))
        cubic = CubicSpline(keep, seen[keep, marker])(gap)
        errors.append(
            [((x - truth[gap, marker]) ** 2).mean() for x in (filled.positions_mm[gap, marker], cubic)]
        )
        assert (sd_mm[gap, marker] > 0).all()
    cosines, cubics = np.sqrt(np.mean(errors, axis=0))
    assert cosines <= 1.6
    assert cosines <= 0.7 * cubics


def test_rigid_motion_is_removed_by_the_jig_and_least_squares(simulated):
    face, seen = simulated
    raw = mouth_error_mm(seen, face)
    capture = Capture(seen, RATE_HZ, NAMES)
    stable, motion = remove_head_motion(capture, SHAPE, [*JIG, *UPPER], allow_scale=False)
    kept = mouth_error_mm(stable.positions_mm, face)
    assert raw[0] > 10.0
    assert max(kept) < 0.6
    assert np.median(motion.residual_mm) < 1.0


def error_after_slip_mm(simulated, columns, cutoff_mm):
    face, seen = simulated
    capture = Capture(seen, RATE_HZ, NAMES)
    stable = remove_head_motion(capture, SHAPE, columns, allow_scale=False, cutoff_mm=cutoff_mm)[0]
    return mouth_error_mm(stable.positions_mm, face)[1]


def test_jig_and_least_squares_together_survive_a_slip_that_the_jig_alone_does_not(simulated):
    both = error_after_slip_mm(simulated, [*JIG, *UPPER], 1.0)
    assert error_after_slip_mm(simulated, [*JIG], 1.0) > 2.5 * both
    assert error_after_slip_mm(simulated, [*JIG, *UPPER], 1e6) > both


def test_a_jig_that_slips_far_is_no_longer_believed():
    far = simulate(slip_mm=6.0)
    robust = error_after_slip_mm(far, [*JIG, *UPPER], 1.0)
    assert robust < 0.6
    assert error_after_slip_mm(far, [*JIG, *UPPER], 1e6) > 2 * robust


def test_missing_segments_are_reconstructed_and_stay_marked(simulated):
    _, seen = simulated
    hidden = seen.copy()
    hidden[600:606, 24] = np.nan
    cleaned = clean_captures([Capture(hidden, RATE_HZ, NAMES)], [*JIG, *UPPER], allow_scale=False)
    whole = clean_captures([Capture(seen, RATE_HZ, NAMES)], [*JIG, *UPPER], allow_scale=False)
    bridged = cleaned.captures[0].positions_mm[600:606, 24] - whole.captures[0].positions_mm[600:606, 24]
    assert np.sqrt((bridged**2).mean()) < 0.3
    assert (cleaned.captures[0].flags[600:606, 24] == int(FrameFlag.FILLED)).all()
    assert cleaned.captures[0].flags[599, 24] == int(FrameFlag.MEASURED)


def test_afterwards_the_motions_are_spatially_aligned(simulated):
    """ "This last step has the added benefit that the motion samples are initially spatially aligned"."""
    _, seen = simulated
    turned = seen @ Rotation.from_rotvec([0.1, 0.3, 0.0]).as_matrix() + [40.0, -20.0, 100.0]
    pair = [Capture(seen[:1200], RATE_HZ, NAMES), Capture(turned[1200:], RATE_HZ, NAMES)]
    cleaned = clean_captures(pair, [*UPPER], allow_scale=False).captures
    left, right = cleaned[0].positions_mm[-1, MOUTH], cleaned[1].positions_mm[0, MOUTH]
    assert np.linalg.norm(turned[1200, MOUTH] - seen[1199, MOUTH], axis=1).min() > 50.0
    assert np.linalg.norm(right - left, axis=1).max() < 2.0
