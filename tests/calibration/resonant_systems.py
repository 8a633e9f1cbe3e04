"""Resonant systems of known order, modes and noise, as a stage has them: what identification is tried on.

1 kHz where nothing else is said.  Noise is 20 dB below the response: half of its power has passed through the
resonances (as many white forces as there are inputs, each at a place of its own), half is white on the outputs.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, solve_discrete_are, solve_discrete_lyapunov
from scipy.signal import chirp

from calibration.state_space.model import InnovationModel

RATE = 1000.0
NOISE = 0.01
"""Power of all noise over that of the response: -20 dB."""


@dataclass(frozen=True)
class ResonantSystem:
    """A system with its noise, and the innovation form that predicts it best.

    Parameters
    ----------
    model : InnovationModel
        The truth: with the Kalman gain of the noise below.
    process : array, shape (n, forces), 1
        A root of the process noise's covariance.
    measurement : array, shape (p,), any unit
        Standard deviation of each output's own noise.
    """

    model: InnovationModel
    process: np.ndarray
    measurement: np.ndarray

    def record(
        self, samples: int, seed: int, drive: np.ndarray | None = None, noise: float = 1.0
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return a drive, white where none is given, and a response: shapes (samples, m) and (samples, p)."""
        rng = np.random.default_rng(seed)
        drive = rng.standard_normal((samples, self.model.inputs)) if drive is None else drive
        forces = self.process.shape[1]
        sources = InnovationModel(
            self.model.A,
            np.concatenate([self.model.B, noise * self.process], axis=1),
            self.model.C,
            np.concatenate([self.model.D, np.zeros((self.model.outputs, forces))], axis=1),
            self.model.K,
            self.model.rate,
            self.model.innovation,
        )
        response = sources.simulate(np.concatenate([drive, rng.standard_normal((samples, forces))], axis=1))
        return drive, response + noise * self.measurement * rng.standard_normal(response.shape)


def order_7(rate: float = RATE) -> ResonantSystem:
    """Return one input, one output: 62, 95 and 128 Hz and a pole at 12 Hz."""
    return _system([62.0, 95.0, 128.0], [0.01, 0.015, 0.01], inputs=1, outputs=1, seed=17, pole=12.0, rate=rate)


def order_9() -> ResonantSystem:
    """Return one input, three outputs: as `order_7`, and 210 Hz."""
    return _system([62.0, 95.0, 128.0, 210.0], [0.01, 0.015, 0.01, 0.01], inputs=1, outputs=3, seed=9, pole=12.0)


def order_18() -> ResonantSystem:
    """Return three inputs, three outputs: nine modes."""
    frequency = [31.0, 47.0, 62.0, 78.0, 95.0, 128.0, 163.0, 210.0, 290.0]
    damping = [0.02, 0.015, 0.01, 0.012, 0.015, 0.01, 0.015, 0.01, 0.015]
    return _system(frequency, damping, inputs=3, outputs=3, seed=6)


def sweep(samples: int, low: float, high: float) -> np.ndarray:
    """Return a chirp, shape (samples, 1), of the amplitude that has unit power."""
    time = np.arange(samples) / RATE
    return np.sqrt(2.0) * chirp(time, low, time[-1], high)[:, None]


def _system(
    frequency: list[float],
    damping: list[float],
    inputs: int,
    outputs: int,
    seed: int,
    pole: float | None = None,
    rate: float = RATE,
) -> ResonantSystem:
    """Add modes of like power in the response to white noise, each with a shape of its own."""
    rng = np.random.default_rng(seed)
    continuous = 2 * np.pi * np.array(frequency) * (-np.array(damping) + 1j * np.sqrt(1 - np.array(damping) ** 2))
    blocks = [np.array([[z.real, z.imag], [-z.imag, z.real]]) for z in np.exp(continuous / rate)]
    if pole is not None:
        blocks.append(np.array([[np.exp(-2 * np.pi * pole / rate)]]))
    transition = block_diag(*blocks)
    order = len(transition)
    inlet, outlet = rng.standard_normal((order, inputs)), rng.standard_normal((outputs, order))
    start = 0
    for block in blocks:
        part = slice(start, start + len(block))
        start += len(block)
        power = _power(transition[part, part], inlet[part], outlet[:, part]).sum()
        outlet[:, part] /= np.sqrt(power)
    outlet /= np.sqrt(_power(transition, inlet, outlet))[:, None]
    process = rng.standard_normal((order, inputs))
    process *= np.sqrt(NOISE / 2 / _power(transition, process, outlet).mean())
    measurement = np.sqrt(np.full(outputs, NOISE / 2))
    covariance = solve_discrete_are(transition.T, outlet.T, process @ process.T, np.diag(measurement**2))
    innovation = outlet @ covariance @ outlet.T + np.diag(measurement**2)
    gain = np.linalg.solve(innovation, outlet @ covariance @ transition.T).T
    direct = np.zeros((outputs, inputs))
    return ResonantSystem(
        InnovationModel(transition, inlet, outlet, direct, gain, rate, innovation), process, measurement
    )


def _power(transition: np.ndarray, inlet: np.ndarray, outlet: np.ndarray) -> np.ndarray:
    """Return each output's power under unit white noise at every input, shape (p,)."""
    return np.diag(outlet @ solve_discrete_lyapunov(transition, inlet @ inlet.T) @ outlet.T)
