"""A prefilter leaves less of the deflection it was made for, keeps the loop's bounds, and is refused elsewhere.

Guards against a filter that looks good in its own formulas: what it leaves is measured in time, and its bounds are
looked at on other lines than those it was made on.
"""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

from stagectl.config import Outer
from stagectl.experiments.piezo.prefilter_file import read_prefilters, write_prefilters
from stagectl.stage.bounded_fit import bounded_fit
from stagectl.stage.design import Design, design
from stagectl.stage.design_bounds import mistuned
from stagectl.stage.disturbance import Disturbance, disturbance
from stagectl.stage.prefilter import LARGEST, Prefilter, prefilter, refuse_unfit
from stagectl.stage.prefiltered_reference import PrefilteredReference
from stagectl.stage.state_space import StateSpace, plant_of
from tests.stagectl.experiments.piezo.linear_stage import RATE, model

LATE = 5e-4


@cache
def chosen() -> Design:
    return design(model("x"), Outer(), 0)


def deflection(seed: int, seconds: float = 16.0) -> np.ndarray:
    """Return what a robot that rings at 13 and 24 Hz, and shakes at 45, gives way by: shape (N,), m."""
    rng = np.random.default_rng(seed)
    whole = np.zeros(round(seconds * RATE))
    for frequency, size in ((13.0, 3e-6), (24.0, 1.5e-6)):
        pole = np.exp(2 * np.pi * frequency / RATE * (1j - 0.03))
        part = lfilter([1.0], [1.0, -2 * pole.real, abs(pole) ** 2], rng.standard_normal(len(whole)))
        whole += size * part / np.std(part)
    return whole + 1e-6 * np.sin(2 * np.pi * 45.0 * np.arange(len(whole)) / RATE)


@cache
def made() -> Prefilter:
    found = prefilter(chosen(), Outer(), disturbance(deflection(1), RATE), LATE)
    assert found is not None
    return found


def followed(reference: np.ndarray, forward: float) -> np.ndarray:
    """Return the plate's position on its model, sample by sample, shape (N,), m."""
    loop = chosen().loop
    plain, added = loop.from_reference()
    whole = StateSpace(plain.A, plain.B + forward * added.B, plain.C, plain.D + forward * added.D)
    state, out = np.zeros(len(whole.A)), np.empty(len(reference))
    for n, now in enumerate(reference):
        out[n] = whole.C[0] @ state + whole.D[0, 0] * now
        state = whole.A @ state + whole.B[:, 0] * now
    return out


def filtered(filters: Prefilter, reference: np.ndarray) -> np.ndarray:
    block, out = PrefilteredReference([filters]), np.zeros((len(reference), 1))
    block.prepare(RATE, 1)
    block.process(reference[:, None].copy(), out)
    return out[:, 0]


def test_it_leaves_of_another_cut_what_was_foreseen_and_much_less_than_the_loop_alone() -> None:
    robot = deflection(2, 4.0)
    late = round(LATE * RATE)
    seen = np.concatenate([np.zeros(late), robot[:-late]])
    settled = slice(round(0.5 * RATE), None)
    size = np.sqrt(np.mean(robot[settled] ** 2))
    alone = robot - followed(seen, chosen().loop.forward)
    better = robot - followed(filtered(made(), seen), made().forward)
    left, without = (np.sqrt(np.mean(each[settled] ** 2)) / size for each in (better, alone))
    assert without == pytest.approx(made().without, rel=0.2)
    assert 0.4 * made().left < left < 1.1 * made().left  # what was not seen before is counted in, and does not come
    assert left < 0.4 * without


def test_the_bounds_of_the_loop_hold_on_other_lines_and_for_frequencies_in_between() -> None:
    loop, outer = chosen().loop, Outer()
    frequency = np.geomspace(0.37, 4_900.0, 7_001)
    shape = np.abs(made().response(frequency, RATE))
    assert shape.max() < 1.02 * LARGEST
    feedback = loop.system().response(frequency, RATE)
    reference = replace(loop, forward=made().forward).reference_system().response(frequency, RATE)
    for off in (-0.05, -0.031, 0.0, 0.017, 0.05):
        plant = mistuned(plant_of(loop.model), 1.0 + off).response(frequency, RATE)
        answer = np.abs(shape * reference * plant / (1.0 + feedback * plant))
        assert answer.max() < 1.02 * (outer.mistuned_sensitivity if off else outer.max_sensitivity)
        if off == 0.0:  # the loop that a laser makes which sees the plate later than is thought, or earlier
            for wrong in (0.5 * LATE, LATE, -LATE):
                loop_gain = answer * np.abs(1.0 - np.exp(-2j * np.pi * frequency * wrong))
                assert loop_gain.max() < 0.55


def test_a_reference_at_rest_is_kept_and_the_block_is_the_filter_it_says() -> None:
    np.testing.assert_allclose(filtered(made(), np.full(50, 2e-4)), 2e-4, rtol=1e-12)
    noise = np.random.default_rng(3).standard_normal(5_000)
    noise[:2_000] = noise[0]
    taps = np.zeros(1 + (len(made().taps) - 1) * made().spacing)
    taps[:: made().spacing] = made().taps
    wanted = lfilter(taps, [1.0], lfilter(np.full(made().spacing, 1 / made().spacing), [1.0], noise - noise[0]))
    np.testing.assert_allclose(filtered(made(), noise), noise[0] + wanted, atol=1e-9)
    impulse = np.fft.rfft(np.r_[taps, np.zeros(20_000 - len(taps))])
    frequency = np.fft.rfftfreq(20_000, 1 / RATE)[26::50]
    mean = np.exp(-2j * np.pi * np.outer(frequency, np.arange(10)) / RATE).mean(axis=1)
    np.testing.assert_allclose(made().response(frequency, RATE), mean * impulse[26::50], atol=1e-9)


def test_an_axis_without_one_keeps_its_reference_to_the_last_bit_and_no_number_is_not_remembered() -> None:
    block, out = PrefilteredReference([None, made()]), np.zeros((600, 2))
    given = np.random.default_rng(4).standard_normal((600, 2))
    given[100:103] = np.nan
    block.prepare(RATE, 1)
    block.process(given, out)
    np.testing.assert_array_equal(out[:, 0], given[:, 0])
    assert np.isnan(out[100:103]).all()
    assert np.isfinite(out[103:]).all()


def test_a_deflection_that_comes_too_fast_for_any_gain_is_not_made_worse() -> None:
    """At 400 Hz nothing is compensated: what is not seen below must not be given up for it."""
    seen = Disturbance(np.arange(0.0, 500.0, 0.25), np.where(np.arange(0.0, 500.0, 0.25) == 400.0, 1e-12, 0.0))
    found = prefilter(chosen(), Outer(), seen, LATE)
    assert found is None or found.left < found.without
    assert prefilter(chosen(), Outer(), disturbance(np.zeros(50_000), RATE), LATE) is None  # it does not move


def test_the_best_coefficients_without_bounds_are_those_of_least_squares_and_bounds_are_kept() -> None:
    rng = np.random.default_rng(5)
    rows = rng.standard_normal((30, 4)) + 1j * rng.standard_normal((30, 4))
    wanted = rng.standard_normal(30) + 0j
    free = bounded_fit(rows, wanted, 1e-6 * rows)
    both, aims = np.concatenate([rows.real, rows.imag]), np.concatenate([wanted.real, wanted.imag])
    last = np.vstack([np.eye(3), -np.ones(3)])  # the sum is one
    part, *_ = np.linalg.lstsq(both @ last, aims - both[:, 3], rcond=None)
    assert free is not None
    np.testing.assert_allclose(free, last @ part + [0, 0, 0, 1], atol=1e-6)
    bounds = rows / np.abs(rows @ free).max() * 1.05
    held = bounded_fit(rows, wanted, bounds)
    assert held is not None
    assert np.abs(bounds @ held).max() < 1.0 + 1e-6
    assert np.linalg.norm(rows @ held - wanted) > np.linalg.norm(rows @ free - wanted)
    assert bounded_fit(rows, wanted, 1e6 * rows) is None


def test_the_power_of_what_was_seen_lies_where_it_rings_as_wide_as_it_may_ring_elsewhere() -> None:
    seen = disturbance(np.sin(2 * np.pi * 20.0 * np.arange(80_000) / RATE), RATE)
    lines = np.geomspace(0.3, 200.0, 2_000)
    power = seen.power(lines, 30.0)
    near = (lines > 17.5) & (lines < 22.5)
    assert 0.9 < power[near].sum() / power.sum() < 1.0
    assert power[(lines > 19.0) & (lines < 21.0)].min() > 100 * power[lines > 40.0].max()
    with pytest.raises(ValueError, match="the disturbance has 1 s, must have 4 s or more"):
        disturbance(np.zeros(10_000), RATE)
    with pytest.raises(ValueError, match="not finite"):
        disturbance(np.full(50_000, np.nan), RATE)


def test_one_that_was_made_for_another_loop_is_refused() -> None:
    refuse_unfit(made(), chosen(), Outer(), LATE, "prefilter of x")
    with pytest.raises(ValueError, match=r"prefilter of z belongs to another loop: .* must be <= 1"):
        refuse_unfit(made(), design(model("z"), Outer(), 0), Outer(), LATE, "prefilter of z")


def test_a_file_keeps_it_to_the_last_bit(tmp_path: Path) -> None:
    file = tmp_path / "prefilter.json"
    write_prefilters(file, ("x", "y"), RATE, (made(), None))
    found, none = read_prefilters(file, ("x", "y"), RATE)
    assert none is None
    assert found is not None
    np.testing.assert_array_equal(found.taps, made().taps)
    assert (found.spacing, found.forward, found.left) == (made().spacing, made().forward, made().left)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[]", "is a list, must be an object"),
        ("{}", "is no file of prefilters: it has no axes"),
        ('{"rate": 250.0, "axes": {"x": null}}', "rate is 250.0, must be 10000 samples/s"),
        ('{"rate": 10000.0, "axes": {"y": null}}', "the axes are y, must be x"),
        ('{"rate": 10000.0, "axes": {"x": {}}}', r"x is no prefilter: KeyError\('taps'\)"),
        (
            '{"rate": 10000.0, "axes": {"x": {"taps": [0.5], "spacing": 1, "forward": 1, "left": 1, "without": 1}}}',
            "x: the taps' sum is 0.5, must be 1",
        ),
        (
            '{"rate": 10000.0, "axes": {"x": {"taps": [1], "spacing": 0, "forward": 1, "left": 1, "without": 1}}}',
            "1 to 1000 finite taps at a spacing of 1 to 10000 samples",
        ),
    ],
)
def test_what_is_no_prefilter_is_refused_by_name(tmp_path: Path, text: str, reason: str) -> None:
    (tmp_path / "prefilter.json").write_text(text)
    with pytest.raises(ValueError, match=rf"prefilter\.json.*{reason}"):
        read_prefilters(tmp_path / "prefilter.json", ("x",), RATE)
