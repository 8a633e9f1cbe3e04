"""Each procedure of the vibrator's daemon shows what it puts out while it runs."""

import pytest

from rigkit.service.snapshot import snapshot
from tests.rigkit.service.outputs import is_measured_while_it_runs
from tests.vibractl.daemon.bench import Lab

OPTIONS = {"run": {"run": "one", "shots": 1000}, "calibrate": {"model": "found.h5"}}


@pytest.mark.parametrize("procedure", OPTIONS)
def test_the_output_is_measured_while_a_procedure_runs_and_not_before(lab: Lab, procedure: str) -> None:
    assert {each.name for each in lab.rig.procedures} == OPTIONS.keys()
    lab.control.arm(lab.key, "a test")
    assert snapshot(lab.control, 1, 0, 0.0)["output"] == "unknown"
    lab.begin(procedure, **OPTIONS[procedure])
    assert is_measured_while_it_runs(lab.control)
    lab.control.stop("Ada", "seen")
    lab.ended()
