"""Vibrators as they may be, for all that a model says: drawn at random, in lines, with distortion."""

import numpy as np
from scipy.signal import hilbert

from vibractl.learning.law import Law, reference_level
from vibractl.learning.laws import SIGNIFICANT
from vibractl.spectrum import LineSpectrum
from vibractl.transfer_matrix import TransferMatrix

MODEL_REACH = 2.0
"""Hz over which errors of a model go together: half the width of the polynomials it comes from."""
AT_WORK = 0.05
"""Of |G|: how far a model is off at the drive in use, beyond its own variance."""
DISTORTION = (-20.0, -14.0, -26.0, -36.0, -36.0, -39.0, -41.0)
"""dB: what comes of order 1 (of the root itself), 2, ... re the reference, where the vibrator answers as in its band.

This, `AT_WORK` and `SPREAD` are priors, for a model file says nothing of distortion: read off the simulated vibrators
of seeds 11 to 20, see docs/predict.md.
"""
SPREAD = 4.0
"""dB, one standard deviation of each."""
MILDEST, STEEPEST = 2, 3
"""With which power of the amplitude a distortion grows: its order, but not less nor more; linearly beyond amplitude 1,
where friction, stops and the edge of the field have been reached."""
DISTORTION_REACH = 10.0
"""Hz over which the answer to a distortion goes together."""
NOISE = -60.0
"""dB re the reference's lines: beside the objective it does not count."""


class DrawnPlant:
    """One vibrator in lines: Y = G' U + sum over n of G H_n F[a^g cos(n phi)] + N.

    a and phi are amplitude and phase, in time, of what each side does in the reference's own band; a is 1 where the
    reference is loudest.  G' is drawn as `drawn_response` says.  H_n is Gaussian and smooth over frequency: distortion
    is force that arises inside, and is heard as a coil's is.

    Parameters
    ----------
    law : Law
    spectrum : LineSpectrum
        Of the learned lines, as wide as the outputs.
    rng : numpy.random.Generator
        Draws it, and goes on to draw its noise.
    """

    def __init__(self, law: Law, spectrum: LineSpectrum, rng: np.random.Generator) -> None:
        self._spectrum, self._rng = spectrum, rng
        self.response = drawn_response(law.matrix, rng)
        self.noise = np.broadcast_to((reference_level(law.reference) * 10 ** (NOISE / 20)) ** 2, law.reference.shape)
        size = np.abs(law.reference)
        self._own = np.minimum(1.0, size / (SIGNIFICANT * size.max(axis=0))) * law.active[:, None]
        self._window = law.window
        self._side = np.arange(law.matrix.inputs) % law.matrix.outputs  # whose motion a coil's side has
        self._signal = np.zeros((spectrum.frames, law.matrix.outputs))
        self._loudest = np.ones(law.matrix.outputs)
        self._loudest = np.abs(self._motion(law.reference)).max(axis=0)
        self._paths = _paths(law, self._loudest, rng)

    def respond(self, drive: np.ndarray) -> np.ndarray:
        """Return the response (lines, outputs), m/s^2 s, to a drive (lines, inputs), V s."""
        linear = (self.response @ drive[..., None])[..., 0]
        response = linear + _gaussian(linear.shape, self._rng) * np.sqrt(self.noise)
        motion = self._motion(linear)
        size = np.abs(motion)
        turn = motion / np.maximum(size, np.finfo(float).tiny)
        phase = np.ones_like(turn)
        for order, path in enumerate(self._paths, 1):
            phase *= turn
            grown = np.minimum(size, 1.0) ** min(max(order, MILDEST), STEEPEST) * np.maximum(size, 1.0)
            response += (path @ self._spectrum.lines(grown * phase.real)[:, self._side, None])[..., 0]
        self._spectrum.time(response, self._signal)
        return self._spectrum.lines(self._window * self._signal)

    def _motion(self, response: np.ndarray) -> np.ndarray:
        """Return the analytic signal (frames, outputs) of a response in the reference's own band, 1 when loudest."""
        self._spectrum.time(self._own * response, self._signal)
        motion: np.ndarray = hilbert(self._signal, axis=0) / self._loudest
        return motion


def drawn_response(matrix: TransferMatrix, rng: np.random.Generator) -> np.ndarray:
    """Draw G as it may be.

    Each element errs with the model's variance; besides, each accelerometer hears all coils by `AT_WORK` otherwise, as
    when a resonance moves.  Both go together over `MODEL_REACH`.

    Parameters
    ----------
    matrix : TransferMatrix, on an even grid
    rng : numpy.random.Generator

    Returns
    -------
    complex array, shape (lines, outputs, inputs), m/s^2 per V
    """
    shape, frequency = matrix.response.shape, matrix.frequency
    error = np.sqrt(matrix.variance) * _smooth_gaussian(shape, frequency, MODEL_REACH, rng)
    at_work = 1 + AT_WORK * _smooth_gaussian((*shape[:2], 1), frequency, MODEL_REACH, rng)
    drawn: np.ndarray = at_work * (matrix.response + error)
    return drawn


def _paths(law: Law, loudest: np.ndarray, rng: np.random.Generator) -> list[np.ndarray]:
    """Draw G H_n of each order, (lines, outputs, inputs), m/s^2."""
    response, power = law.matrix.response, np.abs(law.reference) ** 2
    usual = np.sqrt((np.linalg.norm(response, axis=2) ** 2 * power).sum(axis=0) / power.sum(axis=0))
    paths = []
    for level in DISTORTION:
        strength = 10 ** ((level + SPREAD * rng.standard_normal()) / 20)
        force = _smooth_gaussian((len(response), 1, law.matrix.inputs), law.matrix.frequency, DISTORTION_REACH, rng)
        paths.append(strength * (loudest / usual)[:, None] * response * force)
    return paths


def _gaussian(shape: tuple[int, ...], rng: np.random.Generator) -> np.ndarray:
    drawn: np.ndarray = (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2)
    return drawn


def _smooth_gaussian(
    shape: tuple[int, ...], frequency: np.ndarray, reach: float, rng: np.random.Generator
) -> np.ndarray:
    """Draw complex numbers of mean square 1 that go together over `reach` Hz along the first axis."""
    lines = max(1, round(reach / (frequency[1] - frequency[0])))
    kernel = np.hanning(2 * lines + 1)[1:-1]
    kernel /= np.linalg.norm(kernel)
    longer = (shape[0] + len(kernel) - 1, *shape[1:])
    drawn = _gaussian(longer, rng).reshape(longer[0], -1)
    smooth = np.stack([np.convolve(column, kernel, mode="valid") for column in drawn.T], axis=1)
    return smooth.reshape(shape)
