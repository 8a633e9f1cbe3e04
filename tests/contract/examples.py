"""One line for every Block in the project: how to build it so that the conformance suite can run it."""

import tempfile
from pathlib import Path
from typing import Literal

import numpy as np

from calibration.milling.sweep_block import Sweep
from calibration.state_space.model import InnovationModel
from ctlblocks import Block, Port, recording, replay
from ctlblocks.basic import Gain
from firmware_sim.clamped_robot import ClampedRobot
from firmware_sim.force_sensor_block import ForceSensor
from firmware_sim.guided_robot import GuidedRobot
from firmware_sim.macro_micro_blocks import MacroMicro
from firmware_sim.milling_blocks import PocketCut
from firmware_sim.plant_blocks import ImpulseResponse, Vibrator, VibratorArray, VibratorImpulseResponse
from firmware_sim.stage_blocks import Milling, PiezoStage
from firmware_sim.stage_excitation import Excitation
from firmware_sim.stage_image import Held
from firmware_sim.toroid_blocks import Toroid
from firmware_sim.tracker_block import TrackerView
from rigkit.faults import KINDS, Faults, FaultTable
from rigkit.stream_recorder import StreamRecorder
from rigkit.stream_writer import Stream
from stagectl import config as stage
from stagectl.experiments.midranging.wired_blocks import LivePair, LiveSeen, LiveSend
from stagectl.experiments.toroid.relative_position import RelativePosition
from stagectl.experiments.toroid.stage_reference import StageReference
from stagectl.experiments.toroid.standstill import Standstill
from stagectl.experiments.trials.trial_path import TrialPath
from stagectl.link.blocks import Excite, Newest, Receive, Send
from stagectl.link.config import Link
from stagectl.link.stage_link import StageLink
from stagectl.planning.pocket import planner
from stagectl.planning.problem import Pocket, milling_types
from stagectl.planning.segments import Segments
from stagectl.robot.arm import irb140
from stagectl.robot.cartesian_correction import CartesianCorrection
from stagectl.robot.clamp_config import Clamping, clamp_procedure
from stagectl.robot.clamp_port import GuidedArm
from stagectl.robot.clamp_program import ClampProgram
from stagectl.robot.clamp_search import ClampSearch
from stagectl.robot.config import CellConfig, Robot
from stagectl.robot.kept_orientation import KeptOrientation
from stagectl.robot.midranging.estimation import Estimation
from stagectl.robot.midranging.internal_model import InternalModel, InternalModelAxis
from stagectl.robot.midranging.reference_governor import Governor
from stagectl.robot.midranging.tuning import LoopModel, lambda_tuned
from stagectl.robot.midranging.valve_position import ValvePosition, ValvePositionAxis
from stagectl.robot.milling.force_model import ForceEstimate
from stagectl.robot.port import RobotPort
from stagectl.robot.port_blocks import JointCommand
from stagectl.robot.program import RobotProgram, TorqueSignals
from stagectl.stage.controller import PiezoController, StageController
from stagectl.stage.guard import VoltageGuard
from stagectl.stage.hysteresis import HysteresisModel
from stagectl.stage.hysteresis_compensation import HysteresisCompensation
from stagectl.stage.kalman import kalman_gain
from stagectl.stage.loop import inner_loops
from stagectl.stage.prefilter import Prefilter
from stagectl.stage.prefiltered_reference import PrefilteredReference
from stagectl.stage.sensors import SensorCheck
from stagectl.stage.servo import servo
from stagectl.stage.state_feedback import StateFeedback, linear_quadratic
from stagectl.still import Still
from stagectl.wire.egm import pack_report
from stagectl.wire.messages import Drive
from stagectl.wire.robot import Report
from tests.contract.conformance import Example
from tests.contract.feed_examples import FEED_EXAMPLES
from tests.contract.laser_examples import LASER_EXAMPLES
from tests.contract.live_examples import LIVE_EXAMPLES
from tests.contract.population_examples import POPULATION_EXAMPLES
from tests.contract.stage_daemon_examples import STAGE_DAEMON_EXAMPLES
from tests.stagectl.robot.milling.torque_models import wide_model
from vibractl.config import Adaptation, Learning, Limits, Watch
from vibractl.fft_plans import Plans
from vibractl.guard import Guard
from vibractl.learner import Learner, Timeline
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.gains import Gains
from vibractl.learning.law import Law
from vibractl.mains import Mains
from vibractl.place import at_accelerometers
from vibractl.spectrum import LineSpectrum
from vibractl.transfer_matrix import TransferMatrix
from vibractl.trial import FrameInput, Trial

POCKET = Pocket(6, 6, 2, "EW", dict.fromkeys(milling_types(2, "EW"), 1.0))
NOISE = np.random.default_rng(7).standard_normal((400, 3))


def _faults() -> Faults:
    """Make a block with another fault on each channel, but those that are not numbers."""
    kinds = [kind for kind in KINDS if kind not in ("nan", "inf")]
    table = FaultTable(kinds)
    for kind in kinds:
        table.inject(kind, kind)
    return Faults(table, [1.0] * len(kinds))


def _replay() -> Block:
    played = recording.Recording(("drive", "left", "right"), ("V", *["m/s^2"] * 2), 44_100.0, NOISE.astype(np.float32))
    return replay.Replay(played, {"response": ("left", "right"), "drive": ("drive",)})


def _measured(plant: type[ImpulseResponse] | type[VibratorImpulseResponse]) -> Block:
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"{drive}.wav" for drive in range(2)]
        for file in files:
            recording.write(file, recording.Recording(("left", "right"), ("1", "1"), 44_100.0, NOISE[:, :2].copy()))
        return plant(files=files)


def _learner() -> Block:
    shot = Timeline(64, 4_096, 240, 44_100.0)
    lines = LineSpectrum(shot.frames, 2, shot.rate, (15.0, 650.0), plans := Plans()).frequency
    response = np.broadcast_to(np.eye(2) + 0j, (len(lines), 2, 2))
    matrix = TransferMatrix(lines, response, np.zeros(response.shape), np.ones(response.shape))
    start, active = np.full((len(lines), 2), 1e-3 + 0j), np.ones(len(lines))
    law = Law(matrix, response, Learning(), 2 * start, start, Gains((0.5,), ()), active, (0, 1), np.eye(2), edge=0.002)
    place = at_accelerometers(np.zeros((shot.frames // 4, 2)), (0, 1))
    mains = Mains(16, 60, shot.total // 4, shot.rate / 4, 650.0)
    return Learner(Algorithm(law, Adaptation(), Watch(), -40.0), shot, 4, 2, place, plans, mains)


STAGE_MODEL = InnovationModel(
    *(np.array(part) for part in ([[0.9, -0.1], [0.1, 0.9]], [[0.1], [0.0]], [[1.0, 1.0]], [[0.0]], [[0.0], [0.0]])),
    10_000.0,
    np.eye(1),
)
SENSORS = stage.Sensors(
    position=(-0.09, 0.09), position_speed=1e3, extension=(-1.0, 1.0), extension_speed=1e3, tolerated=10
)
PREFILTER = Prefilter(np.array([0.5, 0.25, 0.25]), 4, 1.0, 0.0, 1.0)
STAGE = stage.StageConfig(limits=stage.Limits(extension=(-1.0, 1.0), extension_slew=100.0, travel=(-1.0, 1.0)))


def _stage_controller() -> Block:
    states = servo(STAGE.outer, 50.0, 10_000.0)
    gain, inverse = linear_quadratic(STAGE_MODEL, states, 1.0)
    outer = StateFeedback(STAGE_MODEL, kalman_gain(STAGE_MODEL, 1.0), gain, states, inverse, 0.2)
    return StageController(inner_loops(STAGE), [outer] * 3, STAGE.limits)


def _start_stage(block: StageController | PiezoController) -> None:
    block.start(np.full(3, 50.0))


def _open_stage(block: VoltageGuard) -> None:
    voltage = np.empty((1, 3))
    while not block.at_rest:
        block.process(np.zeros((1, 3)), np.zeros((1, 1)), voltage)
    block.open()


def _loops() -> HysteresisModel:
    parts = np.array([0.0, 1e-6, 1e-7, 0.0]), np.array([0.1, 0.0]), np.array([0.0, 0.1])
    return HysteresisModel(-0.1, 0.1, *parts, np.array([0.2, 0.6]), np.array([3e-7, 2e-7]), 44_100.0)


def _internal_model() -> Block:
    loops = [LoopModel.first_order(time, 250.0).of_order(3) for time in (0.1, 1.0)] * 2
    governor = Governor((5.0, -4.0), (1.0, -0.9), limit=0.1, travel=0.03)
    return InternalModel([InternalModelAxis(*loops, governor, middle=0.01, estimation=Estimation(0.5, 100.0))] * 2)


def _robot(mode: Literal["joints", "pose"] = "joints") -> RobotPort:
    return RobotPort(CellConfig(robot=Robot(mode=mode)))


def _guided_arm() -> Block:
    port = _robot()
    port.conversation.guard.place(np.full(6, 0.1))
    signals = TorqueSignals(Robot(), "127.0.0.1", lambda: 0.0)
    program = ClampProgram(RobotProgram.__new__(RobotProgram), (0.85,) * 6, print)
    return GuidedArm(port, program, signals, None)


def _signal(block: GuidedArm) -> None:
    block.signals.newest = np.full(13, 7.0)


def _live_pair() -> LivePair:
    return LivePair(StageLink(Link()), _robot("pose"), (1, 2), 20.0)


def _report_pose(block: LiveSeen) -> None:
    report = pack_report(Report(1, 0.0, np.full(6, 0.1), np.full(6, 0.2), np.full(7, 0.5)))
    block.pair.robot.conversation.take(report, ("127.0.0.1", 1), 0.0)
    block.pair.stage.signal("position")[1].fill(1e-6)


def _hear(*_: object) -> None:
    """Listen to no event."""


EXAMPLES: dict[type[Block], Example] = {
    Gain: Example(lambda: Gain(-2.5, width=2)),
    replay.Replay: Example(_replay),
    replay.Record: Example(lambda: replay.Record([Port("left"), Port("right", width=2)], 400)),
    Faults: Example(_faults),
    StreamRecorder: Example(
        lambda: StreamRecorder(Stream(Path("x.wav"), (Port("left"), Port("right", width=2)), ("a", "b", "c")), _hear)
    ),
    Guard: Example(lambda: Guard(Limits(ramp=0.002, rms=0.05), 2), start=Guard.open),
    Trial: Example(lambda: Trial(NOISE, 2, margin=50)),
    Learner: Example(_learner),
    FrameInput: Example(lambda: FrameInput(2), start=lambda block: block.frame.fill(0.1)),
    Still: Example(Still),
    PrefilteredReference: Example(lambda: PrefilteredReference([None, PREFILTER]), rate=10_000.0),
    StageController: Example(_stage_controller, _start_stage, 10_000.0),
    PiezoController: Example(lambda: PiezoController(inner_loops(STAGE), STAGE.limits), _start_stage, 10_000.0),
    VoltageGuard: Example(lambda: VoltageGuard(stage.Limits(voltage=(-0.05, 0.02)), 3), _open_stage, 10_000.0),
    SensorCheck: Example(lambda: SensorCheck(SENSORS, 3), rate=1_000.0),
    Vibrator: Example(Vibrator),
    VibratorArray: Example(lambda: VibratorArray(hydrophones=2)),
    ImpulseResponse: Example(lambda: _measured(ImpulseResponse)),
    VibratorImpulseResponse: Example(lambda: _measured(VibratorImpulseResponse)),
    PiezoStage: Example(PiezoStage),
    ClampedRobot: Example(ClampedRobot, rate=250.0, silent=16),
    ClampSearch: Example(lambda: ClampSearch(clamp_procedure(Clamping(), irb140().with_tool(0.1), (0, 2))), rate=250.0),
    HysteresisCompensation: Example(lambda: HysteresisCompensation([_loops(), None, _loops()])),
    Held: Example(lambda: Held("force", "N")),
    Excitation: Example(lambda: Excitation(500.0)),
    Milling: Example(lambda: Milling(start=0.0, seconds=5.0)),
    Receive: Example(lambda: Receive(StageLink(Link())), rate=10_000.0),
    Newest: Example(lambda: Newest(StageLink(Link()), "voltage"), start=lambda block: block.sample.fill(7.0)),
    ValvePosition: Example(
        lambda: ValvePosition([ValvePositionAxis(lambda_tuned(0.1, 0.1), lambda_tuned(1.0, 1.0), 0.01, 0.1, 0.05)] * 2),
        rate=250.0,
    ),
    InternalModel: Example(_internal_model, rate=250.0),
    MacroMicro: Example(lambda: MacroMicro(noise=1e-3, gains=((0.5, 1.5),), disturbance=0.1), rate=250.0),
    Send: Example(lambda: Send(StageLink(Link())), rate=10_000.0),
    Excite: Example(lambda: Excite(StageLink(Link()), Drive.VOLTAGE), rate=10_000.0),
    ForceEstimate: Example(lambda: ForceEstimate(wide_model()), rate=250.0),
    Sweep: Example(lambda: Sweep(np.full((300, 6), 0.1), np.ones(300), 1.0), rate=250.0),
    CartesianCorrection: Example(lambda: CartesianCorrection(irb140(), 0.1), rate=250.0),
    JointCommand: Example(lambda: JointCommand(_robot()), rate=250.0),
    GuidedArm: Example(_guided_arm, _signal, 250.0),
    LiveSeen: Example(lambda: LiveSeen(_live_pair()), _report_pose, 250.0),
    LiveSend: Example(lambda: LiveSend(_live_pair(), 0.02), rate=250.0),
    GuidedRobot: Example(lambda: GuidedRobot(arm="kuka"), rate=8_000.0),
    Toroid: Example(lambda: Toroid(seconds=0.5), rate=10_000.0),
    PocketCut: Example(
        lambda: PocketCut(length=0.15, width=0.15, thickness=0.02, cell=5e-4, layer=5e-3), rate=10_000.0
    ),
    ForceSensor: Example(lambda: ForceSensor(sample_rate=8_000.0), rate=8_000.0),
    TrackerView: Example(lambda: TrackerView(delay=0.0), rate=300_000.0),
    TrialPath: Example(lambda: TrialPath(*np.split(np.ones((100, 21)), (3, 9, 15), axis=1), 0.1, (0.02, 0.2))),
    KeptOrientation: Example(lambda: KeptOrientation(1.0, 0.01, 0.02), rate=250.0),
    RelativePosition: Example(
        lambda: RelativePosition((3.0, 3.0, 3.0), (True, False, False), 0.004, 0.01, 0.02), rate=2_000.0
    ),
    StageReference: Example(lambda: StageReference((2e-5, 4.3e-4), 0.1, ("x", "y", "z"), lambda _: None), rate=250.0),
    Standstill: Example(Standstill, rate=250.0),
    Segments: Example(lambda: Segments(POCKET, lambda: planner("exact", POCKET)), rate=250.0),
    **FEED_EXAMPLES,
    **LASER_EXAMPLES,
    **LIVE_EXAMPLES,
    **POPULATION_EXAMPLES,
    **STAGE_DAEMON_EXAMPLES,
}
