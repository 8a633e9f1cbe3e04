"""Processor time before the first shot of a run, the audio process included, against the length of the shot.

Run:  python -m benchmarks.first_shot [--seconds 60] [--measure]
"""

import argparse
import resource
import tempfile
import time
from pathlib import Path

import numpy as np

from rigkit import config as rig_file
from vibractl.audio import Line
from vibractl.capture import Capture
from vibractl.config import RigConfig
from vibractl.fft_plans import Plans
from vibractl.fft_transform import Effort
from vibractl.model_file import write_model
from vibractl.run_setup import create
from vibractl.session import Session
from vibractl.setup import Setup, transforms
from vibractl.transfer_matrix import TransferMatrix


class Reached(Exception):
    """The first shot would be played now."""


def used(whom: int) -> float:
    """Return the processor time, s, of this process, or of those that it has started and that have ended."""
    usage = resource.getrusage(whom)
    return usage.ru_utime + usage.ru_stime


def flat_model(folder: Path, rig: str) -> Path:
    """Write a model of a vibrator that follows its coils, and return its path."""
    lines = np.arange(14.0, 652.0)
    response = np.tile(np.eye(2) + 0j, (len(lines), 1, 1))
    size = np.ones(response.shape)
    write_model(folder / "model.h5", TransferMatrix(lines, response, 1e-6 * size, size, {"rig": rig}))
    return folder / "model.h5"


def until_first_shot(folder: Path, seconds: float) -> Setup:
    """Begin a run up to its first shot, print what it took, and return its set-up."""

    def reached(*_: object) -> Capture:
        raise Reached

    Line.emit = reached  # type: ignore[method-assign]
    marks = [("imports", used(resource.RUSAGE_SELF))]
    signal = f"reference.signal=chirp:40:90:{seconds:g}"
    config = rig_file.load(None, RigConfig, [signal, "reference.amplitude=1", "simulator.speed=1"])
    opened, made = create(folder / "run", config, flat_model(folder, config.rig.name))
    marks.append(("set-up", used(resource.RUSAGE_SELF)))
    with opened:
        session = Session(opened, made)
        try:
            session.run(1, lambda *_: None, lambda: False)
        except Reached:
            marks.append(("session, and waiting for the stream", used(resource.RUSAGE_SELF)))
    before = 0.0
    for name, now in marks:
        print(f"  {name}: {now - before:.2f} s")
        before = now
    stream = used(resource.RUSAGE_CHILDREN)
    print(f"  audio process, from its start to its end: {stream:.2f} s")
    after = before - marks[1][1] + stream
    print(
        f"a shot of {session.seconds:.1f} s: {before + stream:.2f} s of processor time before it begins, "
        f"{(before + stream) / session.seconds:.3f} of its length; {after:.2f} s of that after the set-up"
    )
    return made


def planning(made: Setup, effort: Effort) -> tuple[float, float]:
    """Return the processor time, s, to plan a run's FFTs, and that of one transform there and back of each."""
    begin, plans = time.process_time(), Plans()
    planned = [plans.planned(size, effort) for size in transforms(made.config, made.shot.frames)]
    took, ran = time.process_time() - begin, []
    for _ in range(9):
        begin = time.process_time()
        for each in planned:
            each.time.fill(1.0)
            each.forward()
            each.backward()
        ran.append(time.process_time() - begin)
    return took, float(np.median(ran))


def main() -> None:
    """Read the options and measure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="length of the sweep")
    parser.add_argument("--measure", action="store_true", help="plan by FFTW_MEASURE as well: minutes")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        made = until_first_shot(Path(folder), options.seconds)
    estimate, by_estimate = planning(made, "FFTW_ESTIMATE")
    print(f"FFT plans estimated: {estimate:.3f} s, all transforms of a shot {1e3 * by_estimate:.1f} ms")
    if options.measure:
        measure, by_measure = planning(made, "FFTW_MEASURE")
        print(
            f"FFT plans measured: {measure:.1f} s, all transforms of a shot {1e3 * by_measure:.1f} ms; "
            f"paid back after {(measure - estimate) / max(by_estimate - by_measure, 1e-9):.0f} shots"
        )


if __name__ == "__main__":
    main()
