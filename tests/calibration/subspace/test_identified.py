"""What an identification gives to a person at a prompt: words, figures, other packages' models, files."""

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from calibration import subspace
from calibration.subspace.identified import Identified
from stagectl.models.model_file import read_model
from tests.calibration.resonant_systems import RATE, order_7, order_9

HEAVY = (
    "matplotlib h5py pyfftw sounddevice can serial starlette uvicorn websockets pandas control pydantic rich".split()
)


@pytest.fixture(scope="module")
def found() -> Identified:
    return subspace.identify(*order_9().record(3000, seed=1), RATE, order=9, horizon=20)


def test_its_summary_has_fits_modes_with_errors_and_verdicts(found: Identified) -> None:
    text = found.summary()
    assert text.startswith("order 9, 1 input, 3 outputs, 1000 samples/s: free run ")
    assert "from 3000 samples in 1 record, by moesp, horizon 20 and 20" in text
    assert all(name in text for name in ("y1", "y2", "y3"))
    assert "inputs excite enough for a model of this order" in text
    assert repr(found) == f"<Identified: {text.splitlines()[0]}>"


def test_a_notebook_gets_tables(found: Identified) -> None:
    page = found._repr_html_()  # noqa: SLF001 (what notebooks call)
    assert page.count("<table>") == 2
    assert page.count("<tr>") == 2 + 3 + len(found.poles())


def test_poles_come_with_their_errors_by_rising_frequency(found: Identified) -> None:
    poles = found.poles()
    np.testing.assert_array_equal(poles["pole"], found.model.modes.pole)
    assert np.all(np.diff(poles["frequency"]) >= 0)
    assert np.all(poles["damping_error"][1:] < 0.1 * poles["damping"][1:])


def test_it_is_compared_with_lists_as_with_arrays_and_refuses_other_channels(found: Identified) -> None:
    drive, response = order_9().record(600, seed=2)
    beside = found.compare(drive[:, 0].tolist(), response.tolist())
    np.testing.assert_array_equal(beside.fit.free_run.nrmse, found.compare(drive, response).fit.free_run.nrmse)
    assert np.all(beside.fit.from_rest.nrmse <= beside.fit.one_step.nrmse + 1e-9)
    assert str(beside).count("\n") == 3
    with pytest.raises(ValueError, match="records have 1 outputs, the model has 3"):
        found.compare(drive, response[:, :1])


def test_residuals_and_free_run_are_those_of_the_fit(found: Identified) -> None:
    (left,) = found.residuals()
    moved = found.drives[0].std(), found.responses[0] - found.responses[0].mean(axis=0)
    nrmse = 100 * (1 - np.linalg.norm(left, axis=0) / np.linalg.norm(moved[1], axis=0))
    np.testing.assert_allclose(nrmse, found.fit.one_step.nrmse, atol=1e-6)
    (free,) = found.own.free_run
    assert free.shape == left.shape


def test_figures_show_every_pair_and_every_output(found: Identified) -> None:
    assert len(found.bode().axes) == 6
    assert found.bode(np.array([10.0, 20.0])).axes[0].lines[0].get_xdata().tolist() == [10.0, 20.0]
    assert [axes.get_title(loc="left").split(":")[0] for axes in found.own.draw().axes] == ["y1", "y2", "y3"]


def test_a_band_in_the_figure_is_where_the_response_is_nineteen_times_of_twenty(found: Identified) -> None:
    grid = np.array([10.0, 62.0, 120.0])
    figure, errors = found.bode(grid), found.response_errors(grid)
    size = np.abs(found.model.frequency_response(grid)[:, 0, 0])
    for axes, middle, error in (
        (figure.axes[0], size, errors.magnitude[:, 0, 0]),
        (figure.axes[1], figure.axes[1].lines[0].get_ydata(), np.degrees(errors.phase[:, 0, 0])),
    ):
        corners = axes.collections[0].get_paths()[0].vertices
        for frequency, value, wide in zip(grid, middle, error, strict=True):
            here = corners[np.isclose(corners[:, 0], frequency), 1]
            assert here.min() == pytest.approx(value - 1.96 * wide)
            assert here.max() == pytest.approx(value + 1.96 * wide)


def test_other_packages_get_the_same_response(found: Identified) -> None:
    frequency = np.array([5.0, 62.0, 128.0])
    theirs = found.to_scipy()
    assert theirs.dt == 1 / RATE
    np.testing.assert_array_equal(theirs.A, found.model.A)
    control = pytest.importorskip("control")
    response = control.frequency_response(found.to_control(), 2 * np.pi * frequency).frdata
    np.testing.assert_allclose(np.moveaxis(response, -1, 0), found.model.frequency_response(frequency), rtol=1e-9)


def test_what_is_saved_is_read_again(found: Identified, tmp_path: Path) -> None:
    again = read_model(found.save(tmp_path / "m.h5"))
    np.testing.assert_array_equal(again.A, found.model.A)
    assert again.provenance["method"] == "moesp"


def test_what_a_small_order_leaves_out_is_told_of() -> None:
    small = subspace.identify(*order_7().record(4000, seed=3), RATE, order=3, horizon=20).diagnosis
    assert small.left_out > 0.05
    said = [each for each in small.sentences if "the response has more to it than the model" in each]
    assert said[0].endswith("and standard errors do not hold")
    assert not small.feedback.inputs


LOADED = """
import sys, calibration.subspace
print(*(name for name in sys.modules if name.partition(".")[0] in {}))
"""
FAMILY = "ctlblocks", "rigkit", "vibractl", "stagectl", "calibration", "firmware_sim", "vibrostage"
NEEDED = "calibration", "rigkit", "rigkit.compiled", "rigkit.flush_kernel", "rigkit.column_titles"
SLOW = "scipy.optimize", "scipy.special", "scipy.signal", "scipy.stats", "scipy.sparse"
"""What takes longer to import than the rest together."""


def loaded(packages: Sequence[str]) -> set[str]:
    """Return what of some packages a new process has loaded after `import calibration.subspace`."""
    command = [sys.executable, "-c", LOADED.format(set(packages))]
    return set(subprocess.run(command, capture_output=True, text=True, check=True).stdout.split())


def test_nothing_is_imported_that_identification_does_not_need() -> None:
    """From numpy, scipy, numba and threadpoolctl it is usable beside any other package, and soon there."""
    assert not loaded(HEAVY)
    assert not {name for name in loaded(["scipy"]) if name.startswith(SLOW)}
    assert {name for name in loaded(FAMILY) if not name.startswith("calibration.")} == set(NEEDED)
