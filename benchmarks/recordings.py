"""Speed and memory of what reads recordings: the tables of docs/validation/recordings.md.

`python -m benchmarks.recordings [reading] [commands] [hour] [--write]`, the first two by default: some minutes and
3 GB of disk; `hour` adds a run of 700 shots and noise of an hour, of 8 channels each: half an hour, 6 GB.

Each is a process of its own, with one thread for linear algebra.  Times real time are by the processor's time, starting
and loading included; memory is the most that was resident, that of processes which it started not counted.
"""

import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import h5py
import numpy as np
import scipy.io
import soundfile
from scipy.signal import butter, sosfilt

from benchmarks.page_table import put, table, words
from rigkit.foreign_record import open_signals

RATE = 44_100
MINUTES = 2
"""Of the file that is read in each format."""
REFERENCE = "chirp:40:90:5"
PROGRAMS = Path(sys.executable).parent
FOUR = """
[audio]
drive_channels = [1, 2, 3, 4]
response_channels = [1, 2, 3, 4]
loopback_output = 5
loopback_input = 5
"""
WATER = """
[audio]
far_field_channels = [4, 5, 6]
[characterisation]
preload_band = [30.0, 75.0]
[quality]
where = "far-field"
[simulator]
plant = "vibrator-array"
[simulator.options]
vibrators = 1
hydrophones = 3
distance = 10.0
medium = "water"
"""
"""A vibrator before three hydrophones: with two drives, two responses and the loopback a shot has 8 channels."""


def ran(*command: str) -> tuple[float, float]:
    """Run a command to its end; return its processor's time, s, and the most memory that it had, MB."""
    quiet = [(os.POSIX_SPAWN_OPEN, number, os.devnull, os.O_RDWR, 0) for number in (0, 1, 2)]
    program = str(PROGRAMS / command[0])
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "agg"}
    process = os.posix_spawn(program, [program, *command[1:]], environment, file_actions=quiet)
    _, status, used = os.wait4(process, 0)
    if os.waitstatus_to_exitcode(status):
        raise RuntimeError(f"{' '.join(command)}: status {os.waitstatus_to_exitcode(status)}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1e3


def row(name: str, length: str, seconds: float, *command: str) -> list[str]:
    """Measure a command that is given so many s of recording."""
    used, peak = ran(*command)
    return [name, length, f"{seconds / used:.0f}", f"{peak:.0f}"]


def reading() -> None:
    """Read a file of two drives and two responses in each format, block by block."""
    data = np.round(np.random.default_rng(1).normal(size=(60 * MINUTES * RATE, 4)) * 2**12) / 2**15
    rows = []
    with TemporaryDirectory() as folder:
        for name, write in _writers(data).items():
            path = Path(folder) / name
            write(path)
            begun, frames = time.process_time() + os.times().children_user, 0
            for block in open_signals(path, float(RATE)).blocks():
                frames += len(block)
            used = time.process_time() + os.times().children_user - begun
            rows.append([f"`{path.suffix}`", name.partition(".")[0], f"{frames / RATE / used:.0f}"])
            path.unlink()
    put(table(["suffix", "4 channels at 44.1 kHz", "times real time"], rows), "validation/recordings.md", "reading")


def commands() -> None:
    """Judge recordings and replay runs of several lengths."""
    rows = []
    with TemporaryDirectory() as folder:
        rows += _judged(Path(folder))
        rows += _modelled(Path(folder))
        rows += _replayed(Path(folder))
    put(table(["command", "recording", "times real time", "peak, MB"], rows), "validation/recordings.md", "commands")


def _judged(folder: Path) -> list[list[str]]:
    """Find and judge a shot in the middle of a recording of noise, 2 channels."""
    rows = []
    for minutes, suffix in ((1, "wav"), (10, "wav"), (60, "wav"), (1, "csv"), (10, "csv")):
        path = folder / f"heard.{suffix}"
        _hear(path, 60 * minutes)
        length = f"{suffix.upper()}, 2 channels, {minutes} min"
        rows.append(
            row("`vibractl judge`", length, 60.0 * minutes, "vibractl", "judge", str(path), "--reference", REFERENCE,
                "--set", f"audio.rate={RATE}")
        )  # fmt: skip
        path.unlink()
    return rows


def _replayed(folder: Path) -> list[list[str]]:
    """Replay runs of simulated vibrators, of 5 channels and of 8."""
    rows = []
    (folder / "plain.toml").write_text("")
    (folder / "water.toml").write_text(WATER)
    many = [(1, 60), (10, 5), (100, 5)] + ([(700, 5)] if "hour" in words() else [])
    for rig, channels in (("plain", 5), ("water", 8)):
        config, model = str(folder / f"{rig}.toml"), str(folder / f"{rig}.h5")
        ran("calibrate", "vibrator", "--config", config, "--out", model)
        for shots, seconds in many if rig == "water" else many[1:3]:
            run = folder / f"{rig}-{shots}"
            ran("vibractl", "run", "--config", config, "--model", model, "--reference", f"chirp:30:75:{seconds}",
                "--shots", str(shots), "--out", str(run))  # fmt: skip
            frames = soundfile.info(run / "shots" / "0000.wav").frames
            length = f"{channels} channels, {shots} shot{'s' * (shots > 1)} of {frames / RATE:.1f} s"
            rows.append(row("`vibractl replay`", length, shots * frames / RATE, "vibractl", "replay", str(run)))
            for file in (run / "shots").iterdir():
                file.unlink()
    return rows


def _modelled(folder: Path) -> list[list[str]]:
    """Estimate a transfer matrix from noise on four coils, heard by four sensors."""
    (folder / "four.toml").write_text(FOUR)
    files, rows = [str(folder / name) for name in ("drive.wav", "response.wav")], []
    for minutes in (10, 60) if "hour" in words() else (10,):
        _shake(files, 60 * minutes)
        made = "--config", str(folder / "four.toml"), "--out", str(folder / f"{minutes}.h5")
        rows.append(
            row("`calibrate vibrator --from`", f"WAV, 8 channels, {minutes} min", 60.0 * minutes, "calibrate",
                "vibrator", "--from", *files, *made)
        )  # fmt: skip
    for file in files:
        Path(file).unlink()
    return rows


def _shake(files: Sequence[str], seconds: int) -> None:
    """Write noise of so many s, and what comes of it."""
    rng, band = np.random.default_rng(3), butter(2, [20, 700], "bandpass", fs=RATE, output="sos")
    mixed, first, second = rng.normal(size=(4, 4)) / 4, np.zeros((2, 2, 4)), np.zeros((2, 2, 4))
    drive, response = (soundfile.SoundFile(file, "w", RATE, 4, "PCM_16") for file in files)
    with drive, response:
        for _ in range(seconds // 20):
            sent, first = sosfilt(band, 0.1 * rng.normal(size=(20 * RATE, 4)), axis=0, zi=first)
            heard, second = sosfilt(band, sent @ mixed, axis=0, zi=second)
            drive.write(sent)
            response.write(heard + 1e-4 * rng.normal(size=heard.shape))


def _hear(path: Path, seconds: int) -> None:
    """Write a recording of so many s, with the reference in its middle."""
    rng, period = np.random.default_rng(2), 5 * RATE
    time = np.arange(period) / RATE
    sweep = np.sin(2 * np.pi * (40 * time + 5 * time**2))[:, None] * np.hanning(period)[:, None] ** 0.1
    blocks = seconds // 5
    with soundfile.SoundFile(path, "w", RATE, 2, "FLOAT") if path.suffix == ".wav" else path.open("w") as file:
        for number in range(blocks):
            part = 1e-4 * rng.normal(size=(period, 2)) + (sweep / 400 if number == blocks // 2 else 0.0)
            if path.suffix == ".wav":
                file.write(part)
            else:
                np.savetxt(file, part * 400, "%.7g", ",", header="response_1,response_2" * (not number), comments="")


def _writers(data: np.ndarray) -> dict[str, Callable[[Path], object]]:
    def hdf5(path: Path) -> None:
        with h5py.File(path, "w") as file:
            file.create_dataset("y", data=data, compression="gzip", chunks=(16_384, 4))
            file.attrs["rate"] = RATE

    def text(path: Path) -> None:
        timed = np.column_stack([np.arange(len(data)) / RATE, data])
        np.savetxt(path, timed, "%.9g", ",", header="t,a,b,c,d", comments="")

    mat = {"y": data, "fs": float(RATE)}
    return {
        "24 bits.wav": lambda path: soundfile.write(path, data, RATE, "PCM_24"),
        "double.wav": lambda path: soundfile.write(path, data, RATE, "DOUBLE"),
        "24 bits.flac": lambda path: soundfile.write(path, data, RATE, "PCM_24"),
        "no time, 7 digits.csv": lambda path: np.savetxt(path, data, "%.7g", ",", header="a,b,c,d", comments=""),
        "time and 9 digits.csv": text,
        "compressed.h5": hdf5,
        "version 5.mat": lambda path: scipy.io.savemat(path, mat),
        "version 7.mat": lambda path: scipy.io.savemat(path, mat, do_compression=True),
    }


def main(asked: Sequence[str]) -> None:
    """Do what the command line names."""
    for each in (reading, commands):
        if each.__name__ in asked or not set(asked) - {"hour"}:
            each()


if __name__ == "__main__":
    main(words())
