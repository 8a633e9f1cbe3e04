"""Learning laws side by side on drawn resonant plants whose models are wrong: ours, and those of the textbooks.

Each plant is of 3 to 5 modes and a delay, and its model has other frequencies, dampings and gains, drawn; a trial is of
512 samples, of which the last 128 are silence, and begins at rest.  Nothing is tuned to a plant: gains follow from the
model as the textbooks say.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy.signal import firwin

from vibrostage import ilc

SAMPLES, SILENT = 512, 128
SEEDS = range(9000, 9040)
"""On which nothing was chosen."""
TRIALS = 20
BAND = (0.02, 0.2)
"""Of the sampling frequency: the reference's, and what a Q-filter passes ends at."""
NOISE = 0.002
"""Of the reference's rms, on each sample of each trial."""
LOST = 10.0
"""An error so many times the reference's is a law that has diverged."""
LOST_TEXT = "diverged"
Law = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""From a drive and its response, (samples,) each, to the next drive."""


@dataclass(frozen=True)
class Case:
    """A plant, its model and its reference.

    Parameters
    ----------
    plant, model : array, shape (samples,), 1
        Impulse responses.
    reference : array, shape (samples,), 1
    """

    plant: np.ndarray
    model: np.ndarray
    reference: np.ndarray


def case(seed: int) -> Case:
    """Draw a case."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 6))
    frequency, damping = rng.uniform(0.01, 0.35, count), 10 ** rng.uniform(-2.0, -1.0, count)
    gain, delay = rng.uniform(0.3, 1.0, count) * rng.choice([-1.0, 1.0], count), int(rng.integers(1, 4))
    plant = _impulse(frequency, damping, gain, delay)
    off = 1.0 + rng.normal(0.0, 0.02, count)
    model = _impulse(
        frequency * off, damping * rng.uniform(0.7, 1.4, count), gain * rng.uniform(0.9, 1.1, count), delay
    )
    n = np.arange(SAMPLES - SILENT)
    sweep = np.sin(2 * np.pi * (BAND[0] * n + (BAND[1] - BAND[0]) / (2 * len(n)) * n**2))
    return Case(plant, model, np.pad(np.hanning(len(n)) * sweep, (0, SILENT)))


def laws(drawn: Case) -> Iterator[tuple[str, Law, np.ndarray]]:
    """Yield each law's name, the law, and its first drive, (samples,)."""
    matrix, nothing = ilc.lifted(drawn.model, SAMPLES), np.zeros(SAMPLES)
    spectrum = np.fft.rfft(drawn.model)
    peak, lead = float(np.abs(spectrum).max()), int(np.flatnonzero(drawn.model)[0])
    low_pass = firwin(65, 2 * BAND[1])
    rounded = np.stack([np.convolve(row, low_pass, "same") for row in np.eye(SAMPLES)])
    inverse = np.conj(spectrum) / (np.abs(spectrum) ** 2 + 1e-3 * peak**2)
    p_type = ilc.p_type(1.0 / peak, SAMPLES, lead)
    power = matrix.T @ matrix
    bold, shy = (np.linalg.solve(power + weight * peak**2 * np.eye(SAMPLES), matrix.T) for weight in (1e-3, 0.1))
    wanted = drawn.reference

    def lines(drive: np.ndarray, came: np.ndarray) -> np.ndarray:
        return drive + np.fft.irfft(0.3 * inverse * np.fft.rfft(wanted - came), SAMPLES)

    yield "P-type", lambda u, y: p_type.step(u, wanted - y), nothing
    yield "P-type, low-pass Q", lambda u, y: rounded @ p_type.step(u, wanted - y), nothing
    yield "gradient (the model's adjoint)", lambda u, y: u + matrix.T @ (wanted - y) / peak**2, nothing
    yield "norm-optimal, lifted, change weighed by 0.1", lambda u, y: u + shy @ (wanted - y), nothing
    yield "norm-optimal, lifted, by 0.001", lambda u, y: u + bold @ (wanted - y), nothing
    yield "the same, low-pass Q", lambda u, y: rounded @ (u + bold @ (wanted - y)), nothing
    yield "inverse in each bin, K = 0.3 (the thesis' law)", lines, nothing
    yield "ours, `KalmanILC`", *_ours(spectrum, wanted)


def run(drawn: Case, law: Law, drive: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return the error of each trial over the reference, rms, shape (trials + 1,); infinite once it is lost."""
    size, errors = float(np.linalg.norm(drawn.reference)), np.full(TRIALS + 1, np.inf)
    for trial in range(TRIALS + 1):
        came = np.convolve(drawn.plant, drive)[:SAMPLES]
        errors[trial] = np.linalg.norm(drawn.reference - came) / size
        if not errors[trial] < LOST:
            return np.where(np.arange(TRIALS + 1) < trial, errors, np.inf)
        heard = came + NOISE * size / np.sqrt(SAMPLES) * rng.standard_normal(SAMPLES)
        drive = law(drive, heard)
    return errors


def rows() -> list[list[str]]:
    """Run all laws on all plants, and return a row for each law: medians and worst, % of the reference."""
    found: dict[str, list[np.ndarray]] = {}
    for seed in SEEDS:
        drawn = case(seed)
        for name, law, drive in laws(drawn):
            found.setdefault(name, []).append(run(drawn, law, drive, np.random.default_rng(seed)))
    return [_row(name, np.array(errors)) for name, errors in found.items()]


HEAD = ("law", "median after 5, %", "after 20, %", "worst after 20, %", "worse than at first", "diverged")


def _row(name: str, errors: np.ndarray) -> list[str]:
    five, last = errors[:, 5], errors[:, -1]
    worst = f"{100 * last.max():.3g}" if np.isfinite(last).all() else LOST_TEXT
    grown, lost = int(np.sum(last > 1.0)), int(np.sum(~np.isfinite(last)))
    medians = [f"{100 * each:.3g}" if np.isfinite(each) else LOST_TEXT for each in (np.median(five), np.median(last))]
    return [name, *medians, worst, f"{grown} of {len(last)}", str(lost)]


def _ours(spectrum: np.ndarray, wanted: np.ndarray) -> tuple[Law, np.ndarray]:
    used = slice(1, -1)
    variance = (0.3 * np.abs(spectrum[used])) ** 2 + 1e-4 * float(np.abs(spectrum).max()) ** 2
    law = ilc.KalmanILC(spectrum[used], variance, np.fft.rfft(wanted)[used])
    power = NOISE**2 * float(np.sum(wanted**2))

    def whole(inside: np.ndarray) -> np.ndarray:
        return np.fft.irfft(np.pad(inside, (1, 1)), SAMPLES)

    def step(drive: np.ndarray, came: np.ndarray) -> np.ndarray:
        return whole(law.step(np.fft.rfft(drive)[used], np.fft.rfft(came)[used], noise=power))

    return step, whole(law.drive)


def _impulse(frequency: np.ndarray, damping: np.ndarray, gain: np.ndarray, delay: int) -> np.ndarray:
    n = np.arange(SAMPLES - delay)[:, None]
    omega = 2 * np.pi * frequency
    decay = np.exp(-damping * omega * n) * np.sin(omega * np.sqrt(1 - damping**2) * n)
    response: np.ndarray = np.pad((gain * omega * decay).sum(axis=1), (delay, 0))
    return response
