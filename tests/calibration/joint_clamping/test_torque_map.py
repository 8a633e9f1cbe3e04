import numpy as np
import pytest

from calibration.joint_clamping.torque_map import TorqueMap, TorqueMapError, branches

TIME = np.linspace(0.0, 3.0, 3001)
WAVE = np.sin(2 * np.pi * TIME)


def test_a_map_is_cut_at_its_reversals() -> None:
    cut = branches(TorqueMap(1e-3 * WAVE, WAVE, 1000.0))
    assert cut.reversals == 6
    np.testing.assert_array_equal(np.flatnonzero(np.diff(cut.number)), [249, 749, 1249, 1749, 2249, 2749])
    assert (cut.direction[:250] == 1).all()
    assert (cut.direction[250:750] == -1).all()
    assert cut.since[749] == pytest.approx(2e-3, rel=1e-4)


def test_ripples_are_no_reversals() -> None:
    ripple = 1e-3 * WAVE + 2e-5 * np.sin(2 * np.pi * 40 * TIME)
    assert branches(TorqueMap(ripple, WAVE, 1000.0)).reversals == 6


def test_a_long_record_is_averaged_in_blocks() -> None:
    long = TorqueMap(np.arange(20_000.0), np.arange(20_000.0), 1000.0).thinned()
    assert (len(long.angle), long.rate) == (5_000, 250.0)
    assert long.angle[0] == 1.5


@pytest.mark.parametrize(
    ("angle", "torque", "rate", "says"),
    [
        (WAVE, WAVE[:-1], 1.0, r"shape \(3001,\), torque \(3000,\)"),
        (WAVE[:50], WAVE[:50], 1.0, "50 samples, must have >= 100"),
        (np.where(TIME == TIME[7], np.nan, WAVE), WAVE, 1.0, "angle: sample 7 is not finite"),
        (WAVE, 0 * WAVE, 1.0, "torque is 0 throughout"),
        (WAVE, WAVE, 0.0, "rate is 0.0, must be > 0"),
    ],
)
def test_what_is_no_map_is_refused(angle: np.ndarray, torque: np.ndarray, rate: float, says: str) -> None:
    with pytest.raises(TorqueMapError, match=says):
        TorqueMap(angle, torque, rate)


def test_too_few_reversals_are_refused() -> None:
    with pytest.raises(TorqueMapError, match="turns 2 times, must turn >= 3"):
        branches(TorqueMap(WAVE[:1100], WAVE[:1100], 1000.0))
