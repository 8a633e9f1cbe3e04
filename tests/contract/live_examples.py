"""How to build the Blocks of a live trial, and those that judge its wires in a graph, for the conformance suite."""

import numpy as np

from ctlblocks import Block
from stagectl.devices.wired_stage import WiredPlate, WiredPlateReference
from stagectl.link.config import Link
from stagectl.link.stage_link import StageLink
from stagectl.link.tell import nobody
from stagectl.robot.config import CellConfig, Robot, Tracker
from stagectl.robot.force_config import ForceSensor
from stagectl.robot.live.blocks import LiveForce, LiveReference, LiveRobot, LiveTorques, LiveTracker
from stagectl.robot.live.force_records import ForceRecords
from stagectl.robot.live.wires import LiveWires
from stagectl.robot.port import RobotPort
from stagectl.robot.program import TorqueSignals
from stagectl.robot.wired_force import WiredForce
from stagectl.robot.wired_port import WiredPort
from stagectl.robot.wired_tracker import WiredTracker
from stagectl.wire.egm import pack_report
from stagectl.wire.force_sensor import Record
from stagectl.wire.robot import Report
from stagectl.wire.tracker import Sample, Sighting, pack_sample
from tests.contract.conformance import Example

POSE = np.array([0.5, 0.0, 0.3, 1.0, 0.0, 0.0, 0.0])


def _wires() -> LiveWires:
    return LiveWires(CellConfig(), nobody, now=lambda: 0.0)


def _report(block: LiveRobot) -> None:
    report = pack_report(Report(1, 0.0, np.full(6, 0.1), np.full(6, 0.2), np.full(7, np.nan)))
    block.wires.port.conversation.take(report, ("127.0.0.1", 1), 0.0)


def _log(block: LiveTorques) -> None:
    block.wires.signals = TorqueSignals(Robot(), "127.0.0.1", lambda: 0.0)
    block.wires.signals.take(b"".join(b"%d,0,0,0,0,0,0,1,2,3,4,5,6\n" % n for n in range(3)), 0.0)


def _see(block: LiveTracker) -> None:
    sightings = Sighting(0, 3, 1e-4, POSE), Sighting(7, 3, 2e-4, POSE)
    block.samples.take(b"".join(pack_sample(Sample(n, n / 440, sightings)) for n in range(1, 4)), 0.0)


def _feel(block: LiveForce) -> None:
    block.records.skip()
    for n in (1, 2):  # as many as are for one report
        block.records.accept(Record(n, n, 0, np.full(6, 0.5 * n)), 0.0)


def _rest(block: WiredPlate) -> None:
    block.link.signal("position")[1].fill(1e-6)
    block.link.signal("extension")[1].fill(2e-6)


LIVE_EXAMPLES: dict[type[Block], Example] = {
    LiveRobot: Example(lambda: LiveRobot(_wires()), _report, 250.0),
    LiveTorques: Example(lambda: LiveTorques(_wires()), _log, 2_000.0),
    LiveTracker: Example(lambda: LiveTracker(_wires()), _see, 2_000.0),
    LiveForce: Example(lambda: LiveForce(ForceRecords(ForceSensor())), _feel, 250.0),
    WiredForce: Example(lambda: WiredForce(ForceSensor(), print), rate=500.0),
    WiredPort: Example(lambda: WiredPort(CellConfig(), np.zeros(6)), rate=250.0),
    WiredTracker: Example(lambda: WiredTracker(Tracker(), print), rate=2_000.0),
    WiredPlate: Example(lambda: WiredPlate(StageLink(Link()), 2e-4), _rest, 250.0),
    WiredPlateReference: Example(lambda: WiredPlateReference(StageLink(Link()), 2e-4, 0.02), rate=250.0),
    LiveReference: Example(lambda: LiveReference(RobotPort(CellConfig())), rate=250.0),
}
