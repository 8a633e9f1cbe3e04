"""Outputs without inputs: a model of a time series, which foretells it and tells its spectrum."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.signal import welch

from calibration import subspace
from calibration.fit_measures import nrmse
from calibration.state_space.model import InnovationModel
from stagectl.models.model_file import read_model
from tests.calibration.resonant_systems import RATE, order_9

SYSTEM = order_9().model


def series(samples: int, seed: int) -> np.ndarray:
    """Return what the noise alone does to the outputs, shape (samples, 3), about an operating point."""
    rng = np.random.default_rng(seed)
    innovations = rng.standard_normal((samples, 3)) @ np.linalg.cholesky(SYSTEM.innovation).T
    coloured = InnovationModel(SYSTEM.A, SYSTEM.K, SYSTEM.C, np.eye(3), SYSTEM.K, RATE, SYSTEM.innovation)
    return coloured.simulate(innovations) + 2.0


@pytest.fixture(scope="module")
def found() -> subspace.Identified:
    return subspace.identify(None, series(8000, 1), RATE)


@pytest.mark.slow
def test_it_foretells_nearly_as_well_as_the_truth(found: subspace.Identified) -> None:
    fresh = series(4000, 2)
    truth = nrmse(fresh - 2.0, SYSTEM.predict(np.zeros((4000, 1)), fresh - 2.0)).mean()
    assert truth - found.compare(None, fresh).fit.one_step.nrmse.mean() < 0.5
    for frequency in (62.0, 128.0, 210.0):
        assert np.abs(found.core.modes.frequency - frequency).min() < 2.0


def test_its_spectrum_is_the_series(found: subspace.Identified) -> None:
    frequency, power = welch(series(8000, 1), RATE, nperseg=512, axis=0)
    told = np.einsum("bpp->bp", found.model.spectrum(frequency)).real
    np.testing.assert_allclose(np.median(power[2:-2] / told[2:-2], axis=0), 1.0, atol=0.1)


def test_what_is_shown_is_of_the_prediction(found: subspace.Identified, tmp_path: Path) -> None:
    assert "no inputs, 3 outputs" in repr(found)
    assert "free run" not in found.summary()
    assert "there are no inputs" in found.summary()
    assert "free run" not in found._repr_html_()
    np.testing.assert_array_equal(found.to_scipy().B, found.model.K)
    pytest.importorskip("control")
    of_innovations = found.to_control()
    assert (of_innovations.ninputs, list(of_innovations.input_labels)) == (3, ["e[y1]", "e[y2]", "e[y3]"])
    density, beside = found.bode(), found.compare(None, series(500, 3)).draw()
    assert isinstance(density, Figure)
    assert [each.get_title(loc="left") for each in density.axes] == [f"amplitude density of y{n}" for n in (1, 2, 3)]
    assert "one step ahead" in [each.get_text() for each in beside.axes[0].get_legend().get_texts()]
    np.testing.assert_array_equal(read_model(found.save(tmp_path / "series.h5")).K, found.model.K)


@pytest.mark.parametrize("method", ["n4sid", "pbsid"])
def test_the_other_methods_do_as_well(method: subspace.Method, found: subspace.Identified) -> None:
    other = subspace.identify(None, series(8000, 1), RATE, method=method, order=7, horizon=40)
    np.testing.assert_allclose(other.fit.one_step.nrmse, found.fit.one_step.nrmse, atol=0.6)


def test_records_that_are_lists_have_no_inputs_either() -> None:
    halves = [series(2000, 4), series(1500, 5)]
    assert subspace.identify(None, halves, RATE, order=7, horizon=20).model.inputs == 0
