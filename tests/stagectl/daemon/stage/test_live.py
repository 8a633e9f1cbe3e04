"""The stage behind its link under the daemon: a link that fails is a fault until a person has acknowledged it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from firmware_sim.can_node import CanNode
from firmware_sim.stage_processor import Settings
from rigkit.service.state import State
from stagectl.link.stage_link import StageLink
from tests.contract import monitoring
from tests.contract.monitoring import missing_of
from tests.rigkit.service.described import views_are_described
from tests.stagectl.daemon.bench import Lab, lab_in
from tests.stagectl.experiments.piezo.stage_runs import recording_of
from tests.stagectl.link.stand_in import PATIENT, SILENT, link_to, running
from tests.until import EVER, until


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[tuple[Lab, CanNode]]:
    """Return a stage of first order behind an adapter; it has loops of its own."""
    with bench_in(tmp_path, PATIENT) as made:
        yield made


@contextmanager
def bench_in(tmp_path: Path, silence: float) -> Iterator[tuple[Lab, CanNode]]:
    path = tmp_path / "can"
    wire = [f"link.channel={path}", f"link.silence={silence}", "link.patience=10", "session.live=true"]
    with running(path, Settings(silence=silence, ramp=0.02)) as (node, _):
        lab = lab_in(tmp_path, *wire)
        for model in lab.data.glob("stage-*.h5"):
            model.unlink()
        try:
            yield lab, node
        finally:
            lab.close()


def test_a_run_is_streamed_recorded_and_stopped(bench: tuple[Lab, CanNode]) -> None:
    lab, _ = bench
    lab.control.arm(lab.key, "a test")
    assert lab.gauge("link_lost").value == lab.gauge("led").value == 0
    lab.begin("hold", seconds=100.0, position=[250e-6])
    lab.until_follows()
    until(lambda: abs((lab.gauge("position_z").value or 0.0) - 250e-6) < 1e-6)
    assert lab.gauge("led").value == 1.0
    assert views_are_described(lab.control)["procedure"]["name"] == "hold"
    assert missing_of(lab.control, monitoring.RIG, monitoring.STAGE, monitoring.LINK) == set()
    lab.control.stop("Ada", "smoke")
    assert lab.state is State.DISARMED
    lab.ended()
    record = recording_of(lab.run_folder())
    assert np.abs(record.select(["position_x"]).data[-1] - 250e-6) < 5e-6
    assert [gauge.name for gauge in lab.rig.gauges()] == ["disk_free"]


def test_an_adapter_that_goes_is_a_fault_that_a_person_acknowledges_once_it_is_back(
    bench: tuple[Lab, CanNode],
) -> None:
    lab, node = bench
    lab.begin("hold", seconds=100.0)
    lab.until_follows()
    node.suffer("unplug")
    lab.ended()
    assert lab.state is State.FAULT
    assert "a person must acknowledge" in lab.why
    assert lab.events("link_fault")
    with pytest.raises(OSError, match="Ada cannot acknowledge yet"):
        lab.control.acknowledge(lab.key, "the cable was loose")
    assert lab.state is State.FAULT
    node.suffer("replug")
    until(lambda: acknowledged(lab))
    assert lab.state is State.DISARMED
    lab.begin("hold", run="two", seconds=100.0)
    lab.until_follows()
    lab.control.abort(lab.key, "enough")
    lab.ended()
    assert lab.state is State.ARMED, lab.why


def acknowledged(lab: Lab) -> bool:
    """Acknowledge, if it can be yet."""
    try:
        lab.control.acknowledge(lab.key, "the cable was loose")
    except OSError:
        return False
    return True


@pytest.mark.deadline(SILENT / 2)
def test_a_stage_in_fault_is_not_armed(tmp_path: Path) -> None:
    with bench_in(tmp_path, SILENT) as (lab, _):
        with StageLink(link_to(Path(lab.rig.config.link.channel))) as link:
            link.start()
            assert not link.wait(10**9, EVER)  # no reference comes for it
        with pytest.raises(OSError, match="the stage reports [A-Z]+_[A-Z]+; find out why, then: stagectl acknowledge"):
            lab.control.arm(lab.key, "a test")
        assert lab.state is State.DISARMED
