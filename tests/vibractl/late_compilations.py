"""What numba compiles while an audio stream is open, for every way to open one; each in a process that has compiled
nothing:  python -m tests.vibractl.late_compilations [CASE...]
"""  # noqa: D205, D400

import json
import multiprocessing
import sys
import tempfile
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
import soundfile
from numba.core.dispatcher import Dispatcher

from calibration.experiment import RawFolder
from calibration.output import provenance
from calibration.vibrator import LiveLine, calibrate
from firmware_sim.audio import Stream
from rigkit import config as rig_file
from rigkit.faults import FaultTable
from rigkit.provenance import now
from rigkit.stop import StopRequest
from tests.calibration.far_field_rig import array_config
from vibractl.audio_process import AudioProcess
from vibractl.config import RigConfig
from vibractl.doctor.examination import examine
from vibractl.far_field import delayed
from vibractl.model_file import write_model
from vibractl.run_setup import create
from vibractl.session import Session
from vibractl.supervision import Supervision, input_names
from vibractl.transfer_matrix import TransferMatrix

HERE = ("audio.isolated=false", "session.shots=2", "reference.signal=chirp:40:90:1", "reference.amplitude=0.1")
QUICK = ("characterisation.band=[100, 130]", "characterisation.records=4", "characterisation.period=1")
WET = ("simulator.plant=vibrator-array", "audio.far_field_channels=[4]", "simulator.options.vibrators=1")


def rig(*settings: str) -> RigConfig:
    return rig_file.load(None, RigConfig, (*HERE, *settings))


def run(folder: Path, config: RigConfig) -> None:
    """Learn two shots on a model that is flat, with a table for faults."""
    lines, sides = np.arange(14.0, 652.0), len(config.audio.drive_channels)
    flat = np.tile(np.eye(sides) + 0j, (len(lines), 1, 1))
    size = np.ones(flat.shape)
    about = {"rig": config.rig.name}
    hydrophones = len(config.audio.far_field_channels)
    heard = np.ones((len(lines), hydrophones, sides)) + 0j
    far = delayed(lines, heard, 1e-6 * np.abs(heard), np.abs(heard), np.full(hydrophones, 0.007))
    matrix = TransferMatrix(lines, flat, 1e-6 * size, size, about)
    write_model(folder / "model.h5", matrix, far if hydrophones else None)
    opened, made = create(folder / "run", config, folder / "model.h5")
    table = FaultTable(input_names(config.audio))
    with opened:
        Session(opened, made, Supervision(faults=table)).run(2, lambda *_: None, lambda: False)


def measure(folder: Path, config: RigConfig) -> None:
    """Calibrate."""
    with RawFolder(folder) as raw, LiveLine(config, raw, StopRequest()) as line:
        calibrate(config, raw, line.emit, provenance(config, now(), {}))


def by_impulse_response(folder: Path) -> RigConfig:
    files = []
    for drive in range(2):
        files.append(str(folder / f"{drive}.wav"))
        ring = np.exp(-np.arange(2_000) / 150)[:, None] * np.random.default_rng(drive).standard_normal((2_000, 2))
        soundfile.write(files[-1], 0.02 * ring, 44_100, subtype="FLOAT")
    names = json.dumps(files)
    return rig("simulator.plant=impulse-response", f"simulator.options.files={names}", "audio.blocksize=64")


def of_array() -> RigConfig:
    quick = [text.removeprefix("characterisation.") for text in QUICK]
    config = array_config(2, 1, *quick, "records=6")
    audio = config.audio.model_copy(update={"isolated": False})
    plant = config.simulator.model_copy(update={"plant": "vibrator-array"})
    return config.model_copy(update={"audio": audio, "simulator": plant})


CASES: dict[str, Callable[[Path], None]] = {
    "run": lambda folder: run(folder, rig()),
    "run by the thesis' law": lambda folder: run(folder, rig("learning.law=thesis", "watch.on=true")),
    "run of one side by marker": lambda folder: run(folder, rig("learning.side=1", "audio.alignment=marker")),
    "run before hydrophones": lambda folder: run(
        folder, rig(*WET, "quality.where=far-field", "learning.sensors=far-field")
    ),
    "run of impulse responses": lambda folder: run(folder, by_impulse_response(folder)),
    "calibrate by multisines": lambda folder: measure(folder, rig(*QUICK)),
    "calibrate by a stepped sine": lambda folder: measure(
        folder, rig(*QUICK, "characterisation.method=stepped", "characterisation.passes=1")
    ),
    "calibrate an array of vibrators": lambda folder: measure(folder, of_array()),
    "run with the stream in a process of its own": lambda folder: run(folder, rig("audio.isolated=true")),
    "doctor": lambda _: examine(rig()) and None,
}


def compiled_late(case: str) -> list[str]:
    """Run a case and return what was compiled between the start and the end of its stream."""
    late: list[str] = []
    running: list[object] = []
    compiled, start, close = Dispatcher.compile, Stream.start, Stream.close
    begin, end = AudioProcess.start, AudioProcess.close

    def noted(self: Dispatcher, signature: Any) -> Any:
        if running:
            late.append(f"{self.py_func.__module__}.{self.py_func.__name__}")
        return compiled(self, signature)

    def started(self: Stream) -> None:
        running.append(self)
        start(self)

    def closed(self: Stream, ignore_errors: bool = True) -> None:
        close(self, ignore_errors)
        running.remove(self)

    def begun(self: AudioProcess) -> None:
        begin(self)
        running.append(self)

    def ended(self: AudioProcess) -> None:
        end(self)
        running.remove(self)

    Dispatcher.compile, Stream.start, Stream.close = noted, started, closed
    AudioProcess.start, AudioProcess.close = begun, ended
    with tempfile.TemporaryDirectory() as folder:
        CASES[case](Path(folder))
    return late


def _send(case: str, sender: Connection) -> None:
    sender.send(compiled_late(case))


def main(cases: list[str]) -> None:
    """Print what each case compiles too late, as JSON."""
    context, found = multiprocessing.get_context("fork"), {}
    for case in cases or CASES:
        receiver, sender = context.Pipe(duplex=False)
        process = context.Process(target=_send, args=(case, sender))
        process.start()
        sender.close()
        try:
            found[case] = receiver.recv()
        except EOFError:
            raise SystemExit(f"{case}: the process has died") from None
        process.join()
    print(json.dumps(found, indent=1))  # noqa: T201


if __name__ == "__main__":
    main(sys.argv[1:])
