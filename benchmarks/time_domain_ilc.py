"""Time-domain ILC (6.8): how well a state-space model fits the vibrator, and what learning makes of it.

`python -m benchmarks.time_domain_ilc [SEED ...]`, a minute; prints the table of `docs/validation/learning.md`.  Side 1
of the simulated vibrator is excited from 10 to 400 Hz, identified at orders 18 (the thesis') and 40, and learns the
default reference through the model's non-causal inverse, without audio.
"""

import sys
from dataclasses import dataclass

import numpy as np
from scipy.signal import chirp, firwin, lfilter, resample_poly, ss2zpk
from scipy.signal.windows import tukey

from calibration import subspace
from calibration.fit_measures import vaf
from calibration.state_space.model import InnovationModel
from firmware_sim.plants.vibrator import VibratorPlant
from vibractl.learning.law import reference_level

STEP = 40
RATE = 44_100 / STEP
BAND = (10.0, 400.0)
"""Hz, in which side 1 is excited."""
LEARNED = (15.0, 380.0)
"""Hz, where Q2 lets learning through."""
JUDGED = (101.0, 375.0)
"""Hz, inside what is learned, where errors are judged."""
DRIVE = 0.36
"""V, rms: about what the learned drive has."""
LEAD, SECONDS, TAIL = 0.2, 5.0, 0.4
GAIN = 0.3
"""K of (6.25)."""
SHOTS = 30
HIGHEST = 50.0
"""V: a drive beyond has diverged."""


@dataclass(frozen=True)
class Outcome:
    """What came of one model.

    Parameters
    ----------
    vaf : float, %, free run on a fresh record
    outside : int, zeros outside of the unit circle
    level : array, shape (shots,), dB re the reference's lines
        Worst error between 101 and 375 Hz; shorter where the drive ran away.
    error : array, shape (shots,), m/s^2
        IAE over the samples.
    """

    vaf: float
    outside: int
    level: np.ndarray
    error: np.ndarray


def emitted(plant: VibratorPlant, drive: np.ndarray) -> np.ndarray:
    """Drive coil 1 with (frames,) V at 1102.5 samples/s; return accelerometer 1, (frames,), m/s^2."""
    fine = np.zeros((len(drive) * STEP, 2))
    fine[:, 0] = resample_poly(drive, STEP, 1)
    heard = np.zeros_like(fine)
    plant.run(fine, heard)
    response: np.ndarray = resample_poly(heard[:, 0], 1, STEP)
    return response


def excitation(seconds: float, seed: int) -> np.ndarray:
    """Return a random-phase multisine over `BAND`, V, shape (frames,)."""
    frames = round(seconds * RATE)
    frequency = np.fft.rfftfreq(frames, 1 / RATE)
    phase = np.random.default_rng(seed).uniform(0, 2 * np.pi, len(frequency))
    inside = (frequency >= BAND[0]) & (frequency <= BAND[1])
    signal = np.fft.irfft(inside * np.exp(1j * phase), frames)
    drive: np.ndarray = DRIVE * signal / signal.std()
    return drive


def identified(seed: int, order: int) -> tuple[InnovationModel, float]:
    """Return a model of side 1, and its VAF in percent on a fresh record."""
    records = []
    for seconds, draw in ((60.0, 0), (20.0, 1)):
        drive = excitation(seconds, draw)
        records.append((drive[:, None], emitted(VibratorPlant(STEP * RATE, seed=seed), drive)[:, None]))
    (drive, response), (fresh, wanted) = records
    model = subspace.identify(drive, response, RATE, order=order, horizon=60, direct=True, delay=0).model
    return model, float(vaf(wanted, model.simulate(fresh, model.initial_state(fresh, wanted)))[0])


def outside(model: InnovationModel) -> int:
    """Count the zeros outside of the unit circle."""
    zeros, _, _ = ss2zpk(model.A, model.B, model.C, model.D)
    return int(np.sum(np.abs(zeros) > 1))


def inverted(model: InnovationModel, error: np.ndarray) -> np.ndarray:
    """Filter an error (frames,) with the model's inverse: its stable modes forwards, the others backwards in time.

    Source
    ------
    Markusson, Hjalmarsson and Norrlöf 2002, iterative learning control of nonlinear non-minimum phase systems.
    """
    direct = 1.0 / model.D[0, 0]
    poles, shapes = np.linalg.eig(model.A - direct * model.B @ model.C)
    into = np.linalg.solve(shapes, model.B.astype(complex))[:, 0] * direct
    out = (-direct * model.C @ shapes)[0]
    drive = direct * error.astype(complex)
    for pole, weight in zip(poles, into * out, strict=True):
        if abs(pole) < 1:
            drive += weight * lfilter([0, 1], [1, -pole], error)
        else:
            drive -= weight * lfilter([1 / pole], [1, -1 / pole], error[::-1])[::-1]
    return drive.real


def reference() -> np.ndarray:
    """Return the default reference between its silences, (frames,), m/s^2."""
    sweep = np.arange(round(SECONDS * RATE)) / RATE
    signal = 10.0 * tukey(len(sweep), 0.08) * chirp(sweep, 40, SECONDS, 90)
    return np.pad(signal, (round(LEAD * RATE), round(TAIL * RATE)))


def learned(seed: int, model: InnovationModel) -> tuple[np.ndarray, np.ndarray]:
    """Learn by (6.8) with Q1 = 1 and Q2 a zero-phase band pass; return levels and IAEs as in `Outcome`."""
    wanted, plant = reference(), VibratorPlant(STEP * RATE, seed=seed)
    frequency, lines = np.fft.rfftfreq(len(wanted), 1 / RATE), np.abs(np.fft.rfft(wanted))
    typical = float(reference_level(lines[:, None])[0])
    judged = (frequency > JUDGED[0]) & (frequency < JUDGED[1])
    band_pass = GAIN * firwin(401, LEARNED, fs=RATE, pass_zero=False)
    drive, level, error = np.zeros(len(wanted)), list[float](), list[float]()
    while len(level) <= SHOTS and np.abs(drive).max() < HIGHEST:
        missed = wanted - emitted(plant, drive)
        level.append(float(20 * np.log10(np.abs(np.fft.rfft(missed))[judged].max() / typical)))
        error.append(float(np.abs(missed).sum()))
        drive = drive + np.convolve(inverted(model, missed), band_pass, "same")
    return np.array(level), np.array(error)


def outcome(seed: int, order: int) -> Outcome:
    """Identify, and learn."""
    model, fit = identified(seed, order)
    return Outcome(fit, outside(model), *learned(seed, model))


def row(seed: int, order: int, found: Outcome) -> str:
    """Return a row of the table."""
    best = int(np.argmin(found.error))
    ended = f"{found.level[-1]:.0f}" if len(found.level) > SHOTS else f"diverged at shot {len(found.level) - 1}"
    cells = [seed, order, f"{found.vaf:.1f}", found.outside, best, f"{found.error[0] / found.error[best]:.0f}"]
    return f"| {' | '.join(map(str, [*cells, f'{found.level[best]:.0f}', ended]))} |"


def main(seeds: list[int]) -> None:
    """Print the table."""
    head = ["seed", "order", "VAF, %", "zeros outside", "best shot", "IAE: first / best", "its worst bin, dB"]
    print(f"| {' | '.join([*head, f'... at shot {SHOTS}'])} |")
    print("|---" * (len(head) + 1) + "|")
    for seed in seeds:
        for order in (18, 40):
            print(row(seed, order, outcome(seed, order)), flush=True)


if __name__ == "__main__":
    main([int(text) for text in sys.argv[1:]] or list(range(1, 6)))
