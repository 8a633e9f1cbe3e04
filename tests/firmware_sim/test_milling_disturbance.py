"""The simulated cut against what the thesis says of it."""

import numpy as np
import pytest

from firmware_sim.plants.milling_disturbance import DEFLECTIONS, SPINDLE, TEETH, MillingDisturbance

RATE = 10_000.0


def _drawn(cut: MillingDisturbance, seconds: float = 21.0) -> tuple[np.ndarray, np.ndarray]:
    force, base = np.full((2, round(seconds * RATE), 3), np.nan)
    cut.run(force, base)
    return force, base


def _amplitude(signal: np.ndarray, frequency: float) -> float:
    time = np.arange(len(signal)) / RATE
    window = np.hanning(len(signal))
    line = np.abs(np.sum(window * signal * np.exp(-2j * np.pi * frequency * time)))
    return float(2 * line / window.sum())


@pytest.mark.sample(3)
@pytest.mark.parametrize("direction", "xyz")
@pytest.mark.parametrize("seed", range(1, 6))
def test_the_mean_absolute_deflection_is_the_uncompensated_error_of_table_2_1(direction: str, seed: int) -> None:
    """23.4, 138.4 and 67.0 um, to a thousandth."""
    cut = MillingDisturbance(RATE, direction=direction, seed=seed)
    _, base = _drawn(cut)
    axis = "xyz".index(direction)
    error = np.mean(np.abs(base[cut.cut, axis]))
    assert error == pytest.approx(DEFLECTIONS[direction], rel=1e-3)
    others = np.delete(np.mean(np.abs(base[cut.cut]), axis=0), axis)
    assert np.all(others < 0.3 * error)


@pytest.mark.parametrize("direction", "xyz")
def test_the_robot_rings_between_10_and_30_hz_and_hardly_above(direction: str) -> None:
    """Some micrometres there; above 30 Hz the 95 Hz line alone."""
    cut = MillingDisturbance(RATE, direction=direction)
    _, base = _drawn(cut)
    along = base[cut.cut, "xyz".index(direction)]
    spectrum = np.abs(np.fft.rfft(np.hanning(len(along)) * (along - along.mean()))) ** 2
    frequency = np.fft.rfftfreq(len(along), 1 / RATE)
    power = 2 * spectrum / len(along) / np.sum(np.hanning(len(along)) ** 2)

    def rms(low: float, high: float) -> float:
        return float(np.sqrt(power[(frequency >= low) & (frequency < high)].sum()))

    assert 2e-6 < rms(9, 31) < 6e-6
    assert rms(35, 94) < 0.3e-6
    assert rms(94, 96) == pytest.approx(1.5e-6 / np.sqrt(2), rel=0.1)
    assert rms(97, 5000) < 0.1e-6


def test_the_line_at_95_hz_has_the_amplitude_asked_for() -> None:
    cut = MillingDisturbance(RATE, direction="y", line_amplitude=3e-6)
    _, base = _drawn(cut)
    inside = slice(cut.cut.start + 20_000, cut.cut.stop - 20_000)
    assert _amplitude(base[inside, 1] - np.linspace(base[inside, 1][0], base[inside, 1][-1], 160_000), 95) == (
        pytest.approx(3e-6, rel=0.05)
    )


def test_along_y_the_deflection_grows_to_the_end() -> None:
    """Sörnmo 2015, sec. 2.5: the error will continuously increase when moving along the y-axis."""
    cut = MillingDisturbance(RATE, direction="y")
    _, base = _drawn(cut)
    seconds = base[cut.cut, 1].reshape(20, -1).mean(axis=1)
    assert np.all(np.diff(seconds) > 0)


def test_the_force_passes_with_the_teeth_only_while_the_tool_cuts() -> None:
    cut = MillingDisturbance(RATE, direction="z")
    force, _ = _drawn(cut)
    inside = force[cut.cut.start + 20_000 : cut.cut.stop - 20_000, 2]
    assert np.all(force[: cut.cut.start] == 0)
    assert 15 < inside.mean() < 35
    assert _amplitude(inside - inside.mean(), TEETH * SPINDLE) == pytest.approx(0.6 * inside.mean(), rel=0.05)
    assert np.abs(force).max() < 100


def test_after_the_cut_there_is_no_force_and_the_robot_stays() -> None:
    cut = MillingDisturbance(RATE, seconds=5.0)
    force, base = _drawn(cut, 7.0)
    assert np.all(force[60_000:] == 0)
    assert np.all(base[60_000:] == base[59_999])


def test_a_cut_is_the_same_in_frames_of_any_length() -> None:
    whole = _drawn(MillingDisturbance(RATE, seconds=5.0), 7.0)
    cut, parts = MillingDisturbance(RATE, seconds=5.0), np.full((2, 70_000, 3), np.nan)
    for start in range(0, 70_000, 700):
        cut.run(parts[0, start : start + 700], parts[1, start : start + 700])
    np.testing.assert_array_equal(parts, whole)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"direction": "w"}, "direction is 'w', must be 'x' or 'y' or 'z'"),
        ({"seconds": 1.0}, "seconds is 1.0, must be 5 to 120 s"),
        ({"rate": 1.0}, "rate is 1.0 samples/s, must be 1000 to 100000"),
    ],
)
def test_a_wrong_option_is_refused_by_name(options: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        MillingDisturbance(**{"rate": RATE, **options})  # type: ignore[arg-type]


def test_its_force_is_scaled_alone() -> None:
    (force, base), (stronger, same) = (
        _drawn(MillingDisturbance(RATE, seconds=5.0, force=factor), 6.0) for factor in (1.0, 5.0)
    )
    np.testing.assert_allclose(stronger, 5.0 * force)
    np.testing.assert_array_equal(same, base)
