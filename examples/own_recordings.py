"""A laboratory without a line of this project: SciPy plays sweeps and noise through a vibrator and writes the files.

Run it:  python examples/own_recordings.py FOLDER [SECONDS], and to play a drive that was learned:
         python examples/own_recordings.py NEXT.wav HEARD.wav

The vibrator is a sum of damped modes, two coils to two accelerometers, with a little noise; a recorder that begins with
the player hears it `LATE` samples late.  The files are such as MATLAB, LabVIEW and an audio recorder write.
"""

import sys
import warnings
from pathlib import Path

import numpy as np
from scipy.io import savemat, wavfile
from scipy.signal import bilinear, chirp, lfilter
from scipy.signal.windows import tukey

RATE = 44_100
VOLTS, ACCELERATION = 10.0, 400.0
"""What the number 1 is in sounds, V and m/s^2."""
MODES = ((19.0, 0.05), (47.0, 0.08), (76.0, 0.06), (131.0, 0.03), (212.0, 0.03), (377.0, 0.02))
"""Hz and damping ratio."""
SHAPES = np.array([[2.0, 1.6], [5.0, 4.0], [4.0, -3.0], [1.5, 1.2], [1.2, -1.0], [0.8, 0.9]])
"""m/s^2 per V and mode, of both sides."""
LATE = 23
"""Samples of delay."""
NOISE = 2e-3
"""m/s^2, rms."""


def vibrate(drive: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return what accelerometers record of coils' voltages, both of shape (samples, 2), V and m/s^2."""
    response = NOISE * rng.standard_normal(drive.shape)
    for (frequency, damping), shape in zip(MODES, SHAPES, strict=True):
        omega = 2 * np.pi * frequency
        numerator, denominator = bilinear([1.0, 0.0, 0.0], [1.0, 2 * damping * omega, omega**2], RATE)
        force = drive @ (shape / np.linalg.norm(shape))
        response[LATE:] += np.outer(lfilter(numerator, denominator, force)[:-LATE], shape)
    return response


def sweep(seconds: float) -> np.ndarray:
    """Return one shot: silence, a chirp on both coils, silence, (samples, 2), V."""
    time = np.arange(round(seconds * RATE)) / RATE
    signal = chirp(time, 40.0, seconds, 90.0, phi=-90.0) * tukey(len(time), 0.08)
    return np.pad(np.outer(signal, [1.0, 0.9]), ((round(0.2 * RATE), round(0.4 * RATE)), (0, 0)))


def sound(file: Path, *signals: np.ndarray) -> None:
    """Write a WAV of 32 bits, as an audio recorder does: parts of full scale."""
    wavfile.write(file, RATE, np.hstack(signals).astype(np.float32))


def matlab(file: Path, drive: np.ndarray, response: np.ndarray) -> None:
    """Write what `save('shot.mat', 'fs', 'drive', 'response', '-v7')` writes: columns are channels, V and m/s^2."""
    savemat(file, {"fs": float(RATE), "drive": drive, "response": response}, do_compression=True)


def labview(file: Path, drive: np.ndarray, response: np.ndarray) -> None:
    """Write a table as LabVIEW exports TDMS in half of Europe: semicolons, and commas for points."""
    time = np.arange(len(drive)) / RATE
    head = "time [s];drive_1 [V];drive_2 [V];response_1 [m/s^2];response_2 [m/s^2]"
    rows = np.column_stack((time, drive, response))
    with file.open("w", encoding="utf-8") as table:
        table.write(head + "\n")
        for row in rows:
            table.write(";".join(f"{value:.9g}" for value in row).replace(".", ",") + "\n")


def main(folder: Path, seconds: float) -> None:
    """Play and record everything."""
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(7)
    shot = sweep(seconds)
    noise = 0.4 * rng.standard_normal((round(4 * seconds * RATE), 2)) * tukey(round(4 * seconds * RATE), 0.1)[:, None]
    pause = np.zeros((round(0.7 * RATE), 2))
    session = np.vstack((pause, shot, pause, 1.2 * shot, pause, 0.8 * shot, pause))
    matlab(folder / "shot.mat", shot, vibrate(shot, rng))
    labview(folder / "shot.csv", shot, vibrate(shot, rng))
    sound(folder / "session.wav", session / VOLTS, vibrate(session, rng) / ACCELERATION)
    sound(folder / "noise-drive.wav", noise / VOLTS)
    sound(folder / "noise-response.wav", vibrate(noise, rng) / ACCELERATION)
    sound(folder / "silence.wav", vibrate(np.zeros_like(session), rng) / ACCELERATION)
    print(f"{folder}: {', '.join(sorted(file.name for file in folder.iterdir()))}")


def play(drive: Path, heard: Path) -> None:
    """Play a drive and record the responses."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wavfile.WavFileWarning)  # of a chunk with the largest sample
        rate, data = wavfile.read(drive)
    if rate != RATE:
        raise SystemExit(f"{drive}: {rate} samples/s, must be {RATE}")
    response = vibrate(VOLTS * data.astype(float), np.random.default_rng())
    sound(heard, response / ACCELERATION)
    print(f"{heard}: {len(response) / RATE:.3g} s, at most {np.abs(response).max():.3g} m/s^2")


if __name__ == "__main__":
    given = sys.argv[1:] or ["lab"]
    if given[0].endswith(".wav"):
        play(Path(given[0]), Path(given[1]))
    else:
        main(Path(given[0]), float(given[1]) if len(given) > 1 else 5.0)
