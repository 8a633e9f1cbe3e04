"""One line for every Block in the project: how to build it so that the conformance suite can run it."""

import tempfile
from pathlib import Path

import numpy as np

from ctlblocks import Block, Port, recording, replay
from ctlblocks.basic import Gain, RateHold, Saturation, Sum, UnitDelay
from firmware_sim.plant_blocks import ImpulseResponse, Vibrator, VibratorArray, VibratorImpulseResponse
from firmware_sim.stage_blocks import Milling, PiezoStage
from tests.contract.conformance import Example
from vibractl.algorithm import Algorithm
from vibractl.audio_engine import DeviceInput
from vibractl.config import Adaptation, Learning, Limits, Watch
from vibractl.guard import Guard
from vibractl.law import Law
from vibractl.learner import Learner, Timeline
from vibractl.learning import Gains
from vibractl.spectrum import LineSpectrum
from vibractl.transfer_matrix import TransferMatrix
from vibractl.trial import Trial

NOISE = np.random.default_rng(7).standard_normal((400, 3))


def _replay() -> Block:
    names, units = ("drive", "left", "right"), ("V", "m/s^2", "m/s^2")
    played = recording.Recording(names, units, 44_100.0, NOISE.astype(np.float32))
    return replay.Replay(played, {"response": ("left", "right"), "drive": ("drive",)})


def _measured(plant: type[ImpulseResponse] | type[VibratorImpulseResponse]) -> Block:
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"{drive}.wav" for drive in range(2)]
        for file in files:
            recording.write(file, recording.Recording(("left", "right"), ("1", "1"), 44_100.0, NOISE[:, :2].copy()))
        return plant(files=files)


def _learner() -> Block:
    shot = Timeline(64, 4_096, 240, 44_100.0)
    lines = LineSpectrum(shot.frames, 2, shot.rate, (15.0, 650.0)).frequency
    response = np.broadcast_to(np.eye(2) + 0j, (len(lines), 2, 2))
    matrix = TransferMatrix(lines, response, np.zeros(response.shape), np.ones(response.shape))
    start, active = np.full((len(lines), 2), 1e-3 + 0j), np.ones(len(lines))
    law = Law(matrix, response, Learning(), 2 * start, start, Gains((0.5,), ()), active, (0, 1), np.eye(2))
    return Learner(Algorithm(law, Adaptation(), Watch(), -40.0), shot, 4, 0.002, 2)


EXAMPLES: dict[type[Block], Example] = {
    Sum: Example(lambda: Sum("+-", width=2)),
    Gain: Example(lambda: Gain(-2.5, width=2)),
    Saturation: Example(lambda: Saturation(-0.05, 0.02, width=2)),
    UnitDelay: Example(lambda: UnitDelay(width=2)),
    RateHold: Example(lambda: RateHold(40, width=2)),
    replay.Replay: Example(_replay),
    replay.Record: Example(lambda: replay.Record([Port("left"), Port("right", width=2)], 400)),
    Guard: Example(lambda: Guard(Limits(ramp=0.002, rms=0.05), 2), start=Guard.open),
    Trial: Example(lambda: Trial(NOISE, 2, margin=50)),
    Learner: Example(_learner),
    DeviceInput: Example(lambda: DeviceInput(2), start=lambda block: block.frame.fill(0.1)),
    Vibrator: Example(Vibrator),
    VibratorArray: Example(lambda: VibratorArray(hydrophones=2)),
    ImpulseResponse: Example(lambda: _measured(ImpulseResponse)),
    VibratorImpulseResponse: Example(lambda: _measured(VibratorImpulseResponse)),
    PiezoStage: Example(PiezoStage),
    Milling: Example(lambda: Milling(start=0.0, seconds=5.0)),
}
