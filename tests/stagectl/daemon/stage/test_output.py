"""Each procedure of the stage's daemon shows what it puts out while it runs, simulated and live."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.stage_axes.bench import Bench
from rigkit.service.snapshot import snapshot
from tests.rigkit.service.outputs import is_measured_while_it_runs
from tests.stagectl.daemon.bench import Lab, lab_in
from tests.stagectl.daemon.stage.test_live import bench_in
from tests.stagectl.link.stand_in import PATIENT
from tests.until import until

OPTIONS: dict[str, dict[str, Any]] = {
    "follow": {"run": "one", "reference": "hold", "seconds": 100.0},
    "hold": {"run": "one", "position": [300e-6], "seconds": 100.0},
    "calibrate": {"again": True},
}


@pytest.fixture
def simulated(tmp_path: Path) -> Iterator[Lab]:
    made = lab_in(tmp_path)
    yield made
    made.close()


@pytest.fixture
def live(tmp_path: Path) -> Iterator[Lab]:
    with bench_in(tmp_path, PATIENT) as (made, _):
        yield made


@pytest.mark.sample(3)
@pytest.mark.parametrize("procedure", OPTIONS)
@pytest.mark.parametrize("kind", ["simulated", "live"])
def test_the_output_is_measured_while_a_procedure_runs(
    kind: str, procedure: str, request: pytest.FixtureRequest
) -> None:
    lab: Lab = request.getfixturevalue(kind)
    assert {each.name for each in lab.rig.procedures} == OPTIONS.keys()
    lab.control.arm(lab.key, "a test")
    assert snapshot(lab.control, 1, 0, 0.0)["output"] == {"simulated": "unknown", "live": "zero"}[kind]
    lab.control.begin(lab.key, procedure, OPTIONS[procedure], "")
    assert is_measured_while_it_runs(lab.control)
    lab.control.stop("Ada", "seen")
    lab.ended()


def test_a_simulated_stage_that_is_swept_shows_the_axis_that_moves(simulated: Lab) -> None:
    simulated.control.arm(simulated.key, "a test")
    for model in simulated.data.glob("stage-*.h5"):
        model.unlink()
    simulated.control.begin(simulated.key, "calibrate", {"axis": "x"}, "")
    until(lambda: [axis for axis, volts in driven(simulated).items() if volts] == ["drive_x"])
    found = {gauge.name: gauge for gauge in simulated.rig.gauges()}
    assert {"position_x", "voltage_x", "voltage_z"} <= found.keys()
    assert found["position_x"].high == 430e-6
    simulated.control.stop("Ada", "seen")
    simulated.ended()
    assert [gauge.name for gauge in simulated.rig.gauges()] == ["disk_free"]


def driven(lab: Lab) -> dict[str, float | None]:
    """Return what is put out to each axis, at one time."""
    return {gauge.name: gauge.value for gauge in lab.rig.gauges() if gauge.is_output}


def test_between_two_sweeps_a_simulated_stage_is_at_rest(simulated: Lab) -> None:
    seen: list[tuple[np.ndarray, np.ndarray]] = []
    config = simulated.rig.config
    bench = Bench(config, 0, None, lambda: False, lambda *signals: seen.append(tuple(map(np.copy, signals))))  # type: ignore[arg-type]
    bench.emit(np.full((300, 1), 10.0) * np.hanning(300)[:, np.newaxis])
    voltages = np.array([voltage for _, voltage in seen])
    swept = voltages[-4:-1]  # before, the voltages rise to rest
    assert np.ptp(swept[:, 0]) > 1.0
    np.testing.assert_array_equal(swept[:, 1:], 500.0)
    np.testing.assert_array_equal(voltages[-1], 500.0)
    assert np.isnan(seen[-1][0]).all()
    assert np.isfinite([position for position, _ in seen[:-1]]).all()
