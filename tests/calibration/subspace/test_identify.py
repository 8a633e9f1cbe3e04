"""Subspace identification on systems that are known: order, modes, fit, and what is refused."""

from types import SimpleNamespace

import numpy as np
import pytest

from calibration import subspace
from calibration.fit_measures import fit
from calibration.state_space.model import InnovationModel
from tests.calibration.resonant_systems import RATE, ResonantSystem, order_7, order_9, order_18, sweep

SYSTEMS = {"7, one input, one output": order_7, "9, three outputs": order_9, "18, three inputs and outputs": order_18}
named = pytest.mark.parametrize("system", [make() for make in SYSTEMS.values()], ids=SYSTEMS)


def damping_errors(found: InnovationModel, truth: InnovationModel) -> np.ndarray:
    """Return how far each oscillating mode's damping is off, in parts of it."""
    wanted, got = truth.modes, found.modes
    nearest = [int(np.argmin(np.abs(got.frequency - frequency))) for frequency in wanted.frequency]
    oscillating = wanted.damping < 1
    return np.abs(got.damping[nearest] / wanted.damping - 1)[oscillating]


def shortfall(found: subspace.Identified, system: ResonantSystem) -> tuple[float, float]:
    """Return how many points of NRMSE the truth is better on fresh data: free run, one step."""
    fresh = system.record(20_000, seed=1000)
    truth, ours = fit(system.model, [fresh[0]], [fresh[1]]), found.compare(*fresh).fit
    return (
        float(np.mean(truth.free_run.nrmse - ours.free_run.nrmse)),
        float(np.mean(truth.one_step.nrmse - ours.one_step.nrmse)),
    )


@pytest.mark.sample(3)
@named
@pytest.mark.parametrize("method", ["n4sid", "moesp"])
def test_the_model_is_within_a_tenth_of_a_point_of_the_truth_on_fresh_data(
    system: ResonantSystem, method: subspace.Method
) -> None:
    """10 000 samples; the least standard deviation that any method can have of a damping is up to 1.3 %."""
    found = subspace.identify(*system.record(10_000, seed=3), RATE, order=system.model.order, method=method, horizon=40)
    free_run, one_step = shortfall(found, system)
    assert free_run < (0.2 if system.model.order == 18 else 0.12)
    assert one_step < 0.1
    assert np.all(damping_errors(found.model, system.model) < 0.03)


@named
def test_a_short_past_costs_the_prediction_nothing(system: ResonantSystem) -> None:
    """The best predictor remembers hundreds of samples; the past horizon is 20."""
    found = subspace.identify(*system.record(10_000, seed=3), RATE, order=system.model.order, horizon=20)
    assert shortfall(found, system)[1] < 0.1


@pytest.mark.sample(2)
@named
@pytest.mark.parametrize("horizon", [20, 40])
@pytest.mark.parametrize("method", ["n4sid", "moesp"])
def test_the_order_is_found(system: ResonantSystem, horizon: int, method: subspace.Method) -> None:
    found = subspace.identify(*system.record(10_000, seed=4), RATE, method=method, horizon=horizon)
    assert found.model.order == system.model.order
    assert system.model.order in {each.order for each in found.candidates}


@pytest.mark.sample(1)
@pytest.mark.parametrize("samples", [3000, 10_000])
@pytest.mark.parametrize("horizon", [20, 40])
def test_the_order_is_found_with_a_chirp(samples: int, horizon: int) -> None:
    for system in (order_7(), order_9()):
        record = system.record(samples, seed=5, drive=sweep(samples, 5.0, 150.0))
        assert subspace.identify(*record, RATE, horizon=horizon).model.order == system.model.order


@pytest.mark.parametrize("method", ["n4sid", "moesp"])
def test_an_input_that_its_own_future_tells_does_not_spoil_the_model(method: subspace.Method) -> None:
    """Of a chirp's past little is its own; what N4SID took for it would be noise."""
    system = order_7()
    record = system.record(10_000, seed=5, drive=sweep(10_000, 5.0, 150.0))
    found = subspace.identify(*record, RATE, order=7, method=method, horizon=40)
    truth = fit(system.model, [record[0]], [record[1]])
    assert found.fit.free_run.nrmse > truth.free_run.nrmse - 0.5
    assert np.all(damping_errors(found.model, system.model) < 0.08)


def test_residuals_of_the_right_order_are_white_and_of_too_small_a_one_are_not() -> None:
    system = order_7()
    record, fresh = system.record(10_000, seed=6), system.record(10_000, seed=7)
    right = subspace.identify(*record, RATE, order=7).compare(*fresh).fit
    small = subspace.identify(*record, RATE, order=5).compare(*fresh).fit
    assert right.whiteness.probability > 0.01
    assert right.cross_correlation.outside < 0.1
    assert small.whiteness.probability < 1e-6


@named
@pytest.mark.parametrize("method", ["n4sid", "moesp"])
def test_a_record_without_noise_is_explained_wholly(system: ResonantSystem, method: subspace.Method) -> None:
    drive, response = system.record(2000, seed=8, noise=0.0)
    found = subspace.identify(drive, response, RATE, order=system.model.order, method=method, horizon=20)
    assert np.all(found.fit.free_run.nrmse > 99.999)
    np.testing.assert_allclose(found.model.modes.frequency, system.model.modes.frequency, rtol=1e-6)
    np.testing.assert_allclose(found.model.modes.damping, system.model.modes.damping, rtol=1e-4)


def test_the_order_of_a_record_without_noise_is_its_rank() -> None:
    drive, response = order_7().record(2000, seed=8, noise=0.0)
    assert subspace.identify(drive, response, RATE, horizon=20).model.order == 7


def test_a_pure_delay_without_noise_is_a_model_of_its_length() -> None:
    """All poles coincide at zero, which no set of modes describes."""
    drive = np.random.default_rng(9).standard_normal((1500, 1))
    response = np.concatenate([np.zeros((4, 1)), drive[:-4]])
    found = subspace.identify(drive, response, RATE, order=4, horizon=8)
    assert found.fit.free_run.nrmse > 99.99


def test_two_records_are_one_experiment() -> None:
    system = order_7()
    drive, response = system.record(10_000, seed=10)
    whole = subspace.identify(drive, response, RATE, order=7, horizon=20)
    sides = [[side[:2500], side[2500:]] for side in (drive, response)]
    parts = subspace.identify(*sides, RATE, order=7, horizon=20)
    np.testing.assert_allclose(parts.model.modes.frequency, whole.model.modes.frequency, rtol=1e-3)
    np.testing.assert_allclose(parts.fit.one_step.nrmse, whole.fit.one_step.nrmse, atol=0.1)


def test_a_jump_between_records_is_not_taken_for_dynamics() -> None:
    system = order_7()
    first, second = system.record(5000, seed=11), system.record(5000, seed=12)
    apart = subspace.identify([first[0], second[0]], [first[1], second[1]], RATE, order=7, horizon=20)
    assert np.all(damping_errors(apart.model, system.model) < 0.05)


def test_an_operating_point_is_taken_away_and_reported() -> None:
    system = order_7()
    drive, response = system.record(4000, seed=13)
    plain = subspace.identify(drive, response, RATE, order=7, horizon=20)
    moved = subspace.identify(drive + 5.0, 3.0 * response - 100.0, RATE, order=7, horizon=20)
    np.testing.assert_allclose(moved.input_offset, plain.input_offset + 5.0)
    np.testing.assert_allclose(moved.output_offset, 3.0 * plain.output_offset - 100.0, rtol=1e-6)
    np.testing.assert_allclose(
        moved.model.frequency_response(np.array([10.0, 62.0])),
        3.0 * plain.model.frequency_response(np.array([10.0, 62.0])),
        rtol=1e-6,
    )
    np.testing.assert_allclose(moved.fit.one_step.nrmse, plain.fit.one_step.nrmse, atol=1e-6)


def test_zero_is_the_operating_point_when_the_mean_is_not_to_be_taken_away() -> None:
    drive, response = order_7().record(4000, seed=14)
    found = subspace.identify(drive, response, RATE, order=7, horizon=20, detrend="none")
    assert not np.any(found.input_offset)
    assert not np.any(found.output_offset)


def test_signals_of_very_unlike_size_count_alike() -> None:
    system = order_9()
    drive, response = system.record(6000, seed=15)
    size = np.array([1e-9, 1.0, 1e6])
    plain = subspace.identify(drive, response, RATE, order=9, horizon=20)
    scaled = subspace.identify(1e-3 * drive, size * response, RATE, order=9, horizon=20)
    np.testing.assert_allclose(scaled.fit.free_run.nrmse, plain.fit.free_run.nrmse, atol=1e-6)
    np.testing.assert_allclose(scaled.model.innovation / np.outer(size, size), plain.model.innovation, rtol=1e-5)


def test_the_direct_term_is_found_or_left_out() -> None:
    rng = np.random.default_rng(16)
    drive = rng.standard_normal((4000, 2))
    truth = InnovationModel([[0.8]], [[1.0, 0.5]], [[1.0]], [[0.7, -0.3]], [[0.3]], RATE, [[0.01]])
    response = truth.simulate(drive) + 0.1 * rng.standard_normal((4000, 1))
    np.testing.assert_allclose(subspace.identify(drive, response, RATE, order=1).model.D, truth.D, atol=0.01)
    assert not np.any(subspace.identify(drive, response, RATE, order=1, direct=False).model.D)


def test_a_model_is_stable_even_of_a_record_that_grows() -> None:
    drive = np.random.default_rng(17).standard_normal((600, 1))
    growing = InnovationModel([[1.004]], [[1.0]], [[1.0]], [[0.0]], [[0.0]], RATE, [[1.0]])
    found = subspace.identify(drive, growing.simulate(drive), RATE, order=1, detrend="none")
    assert found.moved_poles == 1
    assert found.model.is_stable


def test_the_predictor_is_stable_and_the_innovations_are_a_covariance() -> None:
    for system in (order_7(), order_18()):
        model = subspace.identify(*system.record(3000, seed=18), RATE, order=system.model.order, horizon=20).model
        assert np.all(np.abs(np.linalg.eigvals(model.A - model.K @ model.C)) < 1)
        assert np.all(np.linalg.eigvalsh(model.innovation) > 0)


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    ("samples", "order", "least", "most"), [(2000, None, 20, 60), (150, 4, 5, 12), (40, 2, 5, 5), (2000, 30, 40, 100)]
)
def test_horizons_suit_order_and_length_where_none_are_given(
    samples: int, order: int | None, least: int, most: int
) -> None:
    found = subspace.identify(*order_7().record(samples, seed=21), RATE, order=order)
    assert least <= found.horizon[0] == found.horizon[1] <= most


def test_past_and_future_can_be_chosen_apart() -> None:
    found = subspace.identify(*order_7().record(4000, seed=22), RATE, order=7, horizon=(15, 45))
    assert found.horizon == (15, 45)
    assert len(found.singular_values) == 30
    assert np.all(damping_errors(found.model, order_7().model) < 0.1)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"order": 0}, r"order is 0, must be a whole number >= 1, or None"),
        ({"order": 20}, r"order is 20, must be 1 to 19"),
        ({"horizon": 300}, r"records have \[500\] samples, too few for horizons of 300 and 300: each must have 600"),
        ({"horizon": (10, 1)}, "horizon is 10 past and 1 future samples, must be at least 1 and 2"),
        ({"order": "auto"}, "order is 'auto', must be a whole number"),
        ({"order": 2.5}, "order is 2.5, must be a whole number"),
        ({"order": True}, "order is True, must be a whole number"),
        ({"order": None, "horizon": None, "y": None}, "output is None, must be an array"),
        ({"horizon": 2.5}, "horizon is 2.5, must be a number of samples, or two"),
        ({"horizon": (3, 4, 5)}, r"horizon is \(3, 4, 5\), must be a number of samples, or two"),
        ({"horizon": "auto"}, "horizon is 'auto', must be a number of samples, or two"),
        ({"delay": "long"}, "delay is 'long', must be 'auto', whole samples or as many"),
        ({"delay": 2.5}, "delay is 2.5, must be 'auto', whole samples or as many"),
        ({"delay": None}, "delay is None, must be 'auto', whole samples or as many"),
        ({"rate": "100"}, "rate is '100', must be a number > 0"),
        ({"rate": None}, "rate is None, must be a number > 0"),
        ({"stable": "no"}, "stable is 'no', must be True or False"),
        ({"direct": "no"}, "direct is 'no', must be True, False or 'auto'"),
        ({"u": np.full(500, 1e300)}, r"input is as large as 1e\+300, must be 1e-100 to 1e\+100"),
        ({"rate": 0.0}, "rate is 0.0, must be a number > 0"),
        ({"u": np.zeros((500, 1))}, "input 1 never changes"),
        ({"u": np.ones(500)}, "input 1 never changes"),
        ({"u": np.full((500, 1), np.nan)}, "500 samples are missing, and between them there is no stretch"),
        ({"u": np.ones((400, 1))}, r"inputs have \[400\] samples and outputs \[500\]"),
        ({"u": []}, "there is no record of input"),
        ({"detrend": "line"}, "detrend is 'line', must be one of mean, record, linear, slow, none"),
        ({"delay": -1}, "delay is -1, must be 0 to 249 samples"),
        ({"delay": (1, 2)}, "delay has 2 entries, must be one number or one for each of 1 inputs"),
        ({"method": "cva"}, "method is 'cva', must be one of auto, n4sid, moesp, pbsid"),
    ],
)
def test_what_cannot_be_identified_is_refused_with_the_reason(change: dict[str, object], said: str) -> None:
    drive, response = order_7().record(500, seed=19)
    arguments = {"u": drive, "y": response, "rate": RATE, "order": 7, "horizon": 20}
    with pytest.raises(ValueError, match=said):
        subspace.identify(**arguments | change)  # type: ignore[arg-type]  # what is wrong is the point


def test_names_and_units_are_those_of_a_table_and_what_is_missing_ends_a_record() -> None:
    drive, response = order_7().record(4_000, seed=20)
    columns = SimpleNamespace(columns=["force [N]"], to_numpy=lambda: drive)
    response[1_500] = np.nan
    with pytest.warns(UserWarning, match="1 of 4000 samples is missing: 3999 in 2 stretches are used"):
        found = subspace.identify(columns, response, RATE, order=7, horizon=20)
    assert (found.model.input_names, found.model.input_units) == (("force",), ("N",))
    assert (found.model.output_names, found.model.output_units) == (("y1",), ("1",))
    pieces = [drive[:1_500], drive[1_501:]], [response[:1_500], response[1_501:]]
    np.testing.assert_array_equal(found.model.A, subspace.identify(*pieces, RATE, order=7, horizon=20).model.A)


def test_lists_and_single_channels_are_records_like_any() -> None:
    drive, response = order_7().record(600, seed=21)
    wanted = subspace.identify(drive, response, RATE, order=3, horizon=10).model
    for pair in ((drive[:, 0], response[:, 0]), (drive.tolist(), response[:, 0].tolist())):
        np.testing.assert_array_equal(subspace.identify(*pair, RATE, order=3, horizon=10).model.A, wanted.A)


@pytest.mark.parametrize(
    ("output", "order", "words"),
    [
        (np.zeros(300) + 1j, None, "output has complex numbers, must be real"),
        (np.ones(300), -2, "order is -2, must be"),
    ],
)
def test_what_is_no_order_or_no_real_signal_is_refused(output: np.ndarray, order: int | None, words: str) -> None:
    drive = np.random.default_rng(1).standard_normal(300)
    with pytest.raises(ValueError, match=words):
        subspace.identify(drive, output, 100.0, order=order)
