"""Models of frequency responses against the systems that the responses are of."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import ArrayLike
from scipy.signal import cont2discrete, dlti

from calibration.frequency_domain import ResponseModel, identify_response, merged
from calibration.frequency_domain.modal_form import ModalForm
from calibration.frequency_domain.response_model import read_response_model
from calibration.state_space.modes import modes as state_space_modes

MODES = np.array([12.0, 31.0, 33.5, 80.0, 140.0])
DAMPING = np.array([0.02, 0.01, 0.03, 0.015, 0.05])


def truth(outputs: int = 2, inputs: int = 2, lag: float | None = 60.0, seed: int = 3) -> ModalForm:
    """Return a structure with five resonances and a lag, s in rad/s."""
    rng = np.random.default_rng(seed)
    omega = 2 * np.pi * MODES
    count = 2 * len(MODES) + (lag is not None)
    decay = DAMPING * omega if lag is None else np.append(DAMPING * omega, 2 * np.pi * lag)
    inlet = rng.uniform(0.5, 1.5, (count, inputs)) * rng.choice([-1, 1], (count, inputs))
    outlet = rng.uniform(0.5, 1.5, (outputs, count)) * np.repeat(omega, 2)[: 2 * len(MODES)].mean()
    return ModalForm(
        decay, omega * np.sqrt(1 - DAMPING**2), inlet, outlet, 0.1 * rng.standard_normal((outputs, inputs))
    )


def at(form: ModalForm, frequency: ArrayLike) -> np.ndarray:
    return form.response(2j * np.pi * np.asarray(frequency))


def noisy(
    form: ModalForm, frequency: np.ndarray, part: float, seed: int = 1
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    clean, rng = at(form, frequency), np.random.default_rng(seed)
    sigma = part * np.abs(clean) * rng.uniform(0.5, 2.0, clean.shape)
    error = sigma / np.sqrt(2) * (rng.standard_normal(clean.shape) + 1j * rng.standard_normal(clean.shape))
    return frequency, clean + error, sigma**2


FREQUENCY = np.arange(4.0, 200.0, 0.25)


@pytest.mark.sample(6)
@pytest.mark.parametrize("rate", [None, 500.0, 44_100.0])
@pytest.mark.parametrize(("outputs", "inputs"), [(1, 1), (2, 2), (3, 1), (1, 3)])
def test_without_noise_it_is_the_system(outputs: int, inputs: int, rate: float | None) -> None:
    """In discrete time as well: a continuous system is followed within its band by one of as many states."""
    form = truth(outputs, inputs)
    found = identify_response(FREQUENCY, at(form, FREQUENCY), order=11, rate=rate)
    expected = at(form, FREQUENCY)
    missed = np.linalg.norm(found.response(FREQUENCY) - expected) / np.linalg.norm(expected)
    assert missed < (1e-6 if rate is None else 0.02)
    if rate is None:
        ringing = found.poles()[found.poles()["damping"] < 0.5]
        np.testing.assert_allclose(ringing["frequency"], MODES, rtol=1e-6)
        np.testing.assert_allclose(ringing["damping"], DAMPING, rtol=1e-4)


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(4))
def test_the_order_is_found_in_noise(seed: int) -> None:
    found = identify_response(*noisy(truth(seed=seed), FREQUENCY, 0.05, seed))
    assert 11 <= found.order <= 12
    assert found.spread == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("late", [4, 9])
def test_the_order_is_found_where_there_is_dead_time(late: int, seed: int) -> None:
    """A sampled mode has two states; each sample of dead time adds one, but the first, which both have."""
    rate, lines = 200.0, np.linspace(0.5, 95.0, 190)
    numerator, denominator, _ = cont2discrete(([2500.0], [1.0, 10.0, 2500.0]), 1 / rate)
    plant = dlti(np.squeeze(numerator)[1:], np.r_[denominator, np.zeros(late - 1)], dt=1 / rate)
    clean, rng = plant.freqresp(2 * np.pi * lines / rate)[1], np.random.default_rng(seed)
    given = clean * (1 + 0.01 * (rng.standard_normal(190) + 1j * rng.standard_normal(190)))
    found = identify_response(lines, given, 2e-4 * np.abs(given) ** 2, rate=rate)
    assert 1 + late <= found.order <= 5 + late
    assert np.sqrt(np.mean(np.abs(found.response(lines).ravel() / clean - 1) ** 2)) < 0.01


def test_it_is_as_good_as_its_noise_allows() -> None:
    """Of 3136 pairs of numbers with errors of 5 % some 49 numbers are fitted: a tenth is left of the errors."""
    form = truth()
    frequency, response, variance = noisy(form, FREQUENCY, 0.05)
    found = identify_response(frequency, response, variance, order=11)
    sigma = np.sqrt(variance)
    weighted = np.sqrt(np.mean(np.abs((found.response(frequency) - at(form, frequency)) / sigma) ** 2))
    assert weighted < 1.3 * np.sqrt(49 / (2 * response.size))


@pytest.mark.sample(2)
@pytest.mark.parametrize("rate", [None, 600.0])
@pytest.mark.parametrize("knows", [True, False])
@pytest.mark.slow
def test_stated_errors_cover(rate: float | None, knows: bool) -> None:
    """Of modes and of the response, in 40 records: 95 % within 1.96 standard errors, give or take."""
    form, lines = truth(1, 2), np.arange(4.0, 200.0, 0.5)
    if rate is not None:
        form = identify_response(lines, at(form, lines), order=11, rate=rate).form  # a truth that such a model can be
    within_response, within_modes = [], []
    for seed in range(40):
        true, clean = _true(form, lines, rate)
        rng = np.random.default_rng(100 + seed)
        sigma = np.full(clean.shape, 0.03 * np.sqrt(np.mean(np.abs(clean) ** 2)))
        error = sigma / np.sqrt(2) * (rng.standard_normal(clean.shape) + 1j * rng.standard_normal(clean.shape))
        found = identify_response(lines, clean + error, sigma**2 if knows else None, order=11, rate=rate)
        off = np.abs(found.response(lines) - clean) / found.errors(lines)
        within_response.append(np.mean(off**2 < 3.0))  # a complex number is chi-square of two degrees, halved
        modes = found.poles()
        pairs = [modes[np.abs(modes["frequency"] - f).argmin()] for f in true["frequency"]]
        for name in ("frequency", "damping"):
            away = [abs(mode[name] - f) / mode[f"{name}_error"] for mode, f in zip(pairs, true[name], strict=True)]
            within_modes.append(np.mean(np.array(away) < 1.96))
    assert 0.92 < np.mean(within_response) < 0.98
    assert 0.9 < np.mean(within_modes) <= 0.99


def _true(form: ModalForm, lines: np.ndarray, rate: float | None) -> tuple[np.ndarray, np.ndarray]:
    """Return ringing modes and response of what is taken for the truth."""
    none = np.zeros((len(form.numbers),) * 2)
    if rate is None:
        scale = 1.0
    else:
        scale = float(np.prod(2 * rate * np.tan(np.pi * lines[[0, -1]] / rate)) ** 0.5)
    model = ResponseModel(form, scale, rate, none, 1.0, (lines[0], lines[-1]))
    modes = model.poles()
    return modes[modes["damping"] < 0.5], model.response(lines)


@pytest.mark.parametrize("rate", [450.0, 2000.0])
def test_at_a_rate_modes_are_those_of_the_matrices(rate: float) -> None:
    found = identify_response(*noisy(truth(1, 2), FREQUENCY, 0.01), order=11, rate=rate)
    expected = state_space_modes(np.linalg.eigvals(found.matrices[0]), rate)
    for name in ("frequency", "damping"):
        np.testing.assert_allclose(found.poles()[name], getattr(expected, name), rtol=1e-9)


@pytest.mark.parametrize("rate", [None, 450.0])
def test_errors_of_modes_follow_those_of_the_numbers(rate: float | None) -> None:
    found = identify_response(*noisy(truth(1, 1), FREQUENCY, 0.01), order=11, rate=rate)
    step, start = 1e-6, found.form.numbers
    for name in ("frequency", "damping"):
        forms = [found.form.with_numbers(start + step * unit) for unit in np.eye(len(start))]
        moved = [(replace(found, form=form).poles()[name] - found.poles()[name]) / step for form in forms]
        expected = np.sqrt(np.einsum("cm,cd,dm->m", moved, found.covariance, moved))
        np.testing.assert_allclose(found.poles()[f"{name}_error"], expected, rtol=1e-3, atol=1e-12)


def test_bands_and_records_are_merged_by_their_variances() -> None:
    form = truth(1, 1)
    low, high = FREQUENCY[FREQUENCY < 60], FREQUENCY[FREQUENCY > 40]
    loud, fine = noisy(form, low, 0.3, 1), noisy(form, low, 0.01, 2)
    found = identify_response(*merged([noisy(form, high, 0.01, 3), loud, fine]), order=11)
    alone = identify_response(*merged([noisy(form, high, 0.01, 3), fine]), order=11)
    clean = at(form, FREQUENCY)
    ours, without = (np.abs(each.response(FREQUENCY) / clean - 1) for each in (found, alone))
    assert np.median(ours) < 1.2 * np.median(without) < 0.01


def test_it_is_stable_and_ready_for_others() -> None:
    found = identify_response(*noisy(truth(), FREQUENCY, 0.2), order=20)
    a, b, c, d = found.matrices
    assert np.linalg.eigvals(a).real.max() < 0
    again = c @ np.linalg.solve(2j * np.pi * 31.0 * np.eye(len(a)) - a, b) + d
    np.testing.assert_allclose(found.response(np.array([31.0]))[0], again, rtol=1e-9)
    for each in (found.to_scipy(), found.to_control()):
        np.testing.assert_allclose(each.A, a)
    told, _, head, *modes = found.summary().splitlines()
    assert told == "20 states, 2 to 2, continuous, 4 to 199.75 Hz"
    assert head.split() == ["frequency,", "Hz", "+-", "damping", "ratio", "+-"]
    assert [float(line.split()[0]) for line in modes] == pytest.approx(list(found.poles()["frequency"]), rel=1e-4)


def test_at_a_rate_its_matrices_are_those_of_a_sampled_system() -> None:
    found = identify_response(*noisy(truth(), FREQUENCY, 0.05), order=11, rate=600.0)
    a, b, c, d = found.matrices
    assert np.abs(np.linalg.eigvals(a)).max() < 1
    again = c @ np.linalg.solve(np.exp(2j * np.pi * 31.0 / 600.0) * np.eye(len(a)) - a, b) + d
    np.testing.assert_allclose(found.response(np.array([31.0]))[0], again, rtol=1e-9)
    assert found.to_scipy().dt == 1 / 600.0


def test_a_file_brings_it_back(tmp_path: Path) -> None:
    found = identify_response(*noisy(truth(), FREQUENCY, 0.05), order=11, rate=600.0)
    again = read_response_model(found.save(tmp_path / "modes.h5", source="a test"))
    np.testing.assert_array_equal(again.response(FREQUENCY), found.response(FREQUENCY))
    np.testing.assert_array_equal(again.errors(FREQUENCY), found.errors(FREQUENCY))
    assert (again.rate, again.band, again.order) == (600.0, found.band, 11)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"frequency": FREQUENCY[:5]}, r"response has shape \(784, 2, 2\) over \(5,\)"),
        ({"frequency": FREQUENCY - 4.0}, "> 0 Hz and rising"),
        ({"frequency": FREQUENCY + 0j}, "frequency is complex, must be real, in Hz: it is given before the response"),
        ({"response": np.ones((784, 2, 2))}, "response is real, must be complex"),
        ({"rate": 300.0}, r"frequency goes to 199.75 Hz, must be below half the rate, 150 Hz"),
        ({"rate": "600"}, "rate is '600', must be a number > 0, samples/s"),
        ({"order": 2.5}, "order is 2.5, must be a whole number >= 1"),
        ({"most": 0}, "most is 0, must be a whole number >= 1"),
        ({"order": 2000}, r"order is 2000, must be 1 to \d+ for 784 bins"),
        ({"variance": np.full((784, 2, 2), -1.0)}, "variance must be finite and >= 0"),
        ({"response": np.zeros((784, 2, 2), complex)}, "response is 0 at all bins"),
        ({"response": np.full((784, 2, 2), np.nan + 0j)}, "response is not finite at 4 Hz"),
    ],
)
def test_what_cannot_be_fitted_is_refused(change: dict[str, object], reason: str) -> None:
    given = {"frequency": FREQUENCY, "response": at(truth(), FREQUENCY), **change}
    with pytest.raises(ValueError, match=reason):
        identify_response(**given)  # type: ignore[arg-type]
