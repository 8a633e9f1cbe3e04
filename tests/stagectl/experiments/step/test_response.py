"""Gain, time constant and dead time, read off plants of which they are known."""

import numpy as np
import pytest
from scipy.signal import lfilter

from ctlblocks.recording import Recording
from stagectl.experiments.step.response import MANIPULATORS, REST, Wanted, figures, response

RATE, NOISE = 250.0, 1e-5


def recorded(wanted: Wanted, plants: dict[str, tuple[float, float, int]], seed: int = 1) -> Recording:
    """Return what manipulators of known gain, time constant (s) and dead time (samples) answer to what is asked."""
    one, random = wanted.excitation(RATE), np.random.default_rng(seed)
    names = wanted.manipulators
    seen = {column: np.zeros(len(one) * len(names)) for column in MANIPULATORS.values()}
    for number, name in enumerate(names):
        gain, constant, late = plants[name]
        pole = np.exp(-1 / (RATE * constant))
        given = np.concatenate([np.zeros(late), one])[: len(one)]
        answer = lfilter([0, gain * (1 - pole)], [1, -pole], given)
        seen[MANIPULATORS[name]][number * len(one) : (number + 1) * len(one)] = answer
    noisy = [each + 0.02 + NOISE * random.standard_normal(len(each)) for each in seen.values()]
    return Recording(tuple(seen), ("m",) * len(seen), RATE, np.column_stack(noisy))


PLANTS = {"robot": (0.95, 0.25, 30), "stage": (1.02, 0.03, 3)}


@pytest.mark.sample(1)
@pytest.mark.parametrize("kind", ["multisine", "step"])
def test_both_manipulators_are_told_apart_and_their_numbers_found_within_their_errors(kind: str) -> None:
    wanted = Wanted(kind=kind, period=4.0, repeats=6)
    off = []
    for seed in range(5):
        record = recorded(wanted, PLANTS, seed)
        for name, (gain, constant, late) in PLANTS.items():
            found = response(record, name, wanted)
            assert found is not None
            true = np.array([gain, constant, late / RATE])
            np.testing.assert_allclose(found.numbers[:2], true[:2], rtol=0.03)
            assert abs(found.numbers[2] - true[2]) < 0.5 / RATE
            assert found.noise == pytest.approx(NOISE, rel=0.1)
            off.append(np.abs(found.numbers - true) / found.errors)
    assert np.mean(np.array(off)[:, :2] < 2.57) > 0.8  # of six repetitions: Student's, with five degrees


def test_the_noise_of_a_manipulator_is_in_its_errors() -> None:
    wanted = Wanted(of="robot", period=4.0)
    quiet, loud = (response(recorded(wanted, PLANTS), "robot", wanted) for _ in range(2))
    assert quiet is not None
    assert loud is not None
    np.testing.assert_array_equal(quiet.numbers, loud.numbers)
    record = recorded(wanted, PLANTS)
    noisier = record.data + 1e-4 * np.random.default_rng(5).standard_normal(record.data.shape)
    found = response(Recording(record.names, record.units, RATE, noisier), "robot", wanted)
    assert found is not None
    assert np.all(found.errors > 2 * quiet.errors)


def test_what_was_cut_short_is_read_as_far_as_it_goes() -> None:
    wanted = Wanted(period=4.0, repeats=3)
    record, one = recorded(wanted, PLANTS), len(wanted.excitation(RATE))

    def cut(samples: int) -> Recording:
        return Recording(record.names, record.units, RATE, record.data[:samples])

    assert set(figures(record, wanted)) == {"asked", "robot", "stage"}
    assert set(figures(cut(one + 100), wanted)) == {"asked", "robot"}
    assert set(figures(cut(round((REST + 8.5) * RATE)), wanted)) == {"asked", "robot"}
    with pytest.raises(ValueError, match="no manipulator was excited for two periods"):
        figures(cut(round((REST + 7.5) * RATE)), wanted)


def test_what_is_asked_begins_and_ends_at_rest_and_is_no_larger_than_it_says() -> None:
    for wanted in (Wanted(period=3.0), Wanted(kind="multisine", period=3.0)):
        asked = wanted.excitation(RATE)
        assert np.abs(asked).max() == pytest.approx(wanted.size)
        rest = round(REST * RATE)
        assert not asked[:rest].any()
        assert not asked[-rest:].any()
    lines = Wanted(kind="multisine", period=3.0).lines(RATE)
    power = np.abs(np.fft.rfft(asked[rest : rest + 750]))
    np.testing.assert_allclose(power[lines], power[1], rtol=1e-9)
    np.testing.assert_allclose(np.delete(power, lines), 0.0, atol=1e-9)


def test_a_multisine_without_lines_is_refused() -> None:
    with pytest.raises(ValueError, match=r"highest is 0\.1 Hz, must be >= 0\.375 Hz: three bins"):
        Wanted(kind="multisine", highest=0.1).excitation(RATE)
