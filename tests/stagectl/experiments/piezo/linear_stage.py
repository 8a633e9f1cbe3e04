"""A small linear stage to try controllers on, made from modes without any of the controllers' code."""

import numpy as np
from scipy.linalg import block_diag, expm

from calibration.state_space.model import InnovationModel
from ctlblocks import Block, Graph, Port
from stagectl.config import Inner, Limits, StageConfig
from stagectl.stage.controller import StageController
from stagectl.stage.loop import Stage

RATE = 10_000.0
RATIO = 5.0
"""m of position per m of extension at rest."""
VOLTS = 0.9e-6
"""m of extension per V."""
AXES = {
    "x": ((62.0, 0.015, 0.6), (95.0, 0.010, 0.25), (128.0, 0.012, 0.15)),
    "y": ((57.0, 0.015, 0.7), (110.0, 0.012, 0.3)),
    "z": ((75.0, 0.020, 1.0),),
}
"""Natural frequency (Hz), damping ratio and share of the position at rest, of each mode."""
LIMITS = Limits(voltage=(0.0, 100.0), voltage_slew=2e5, extension=(2e-6, 88e-6))
INNER = Inner(gain=(VOLTS,), bandwidth=(250.0,), proportional=0.15, lead=0.0)
"""Of this stage's stacks, with 100 V."""
LAG = 1_000.0
"""Hz, of the extension behind the voltage."""


def mechanics(axis: str, factor: float = 1.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return A, B, C from extension (m) to position (m), sampled; natural frequencies times `factor`."""
    return sampled([(frequency * factor, damping, RATIO * share) for frequency, damping, share in AXES[axis]])


def sampled(modes: list[tuple[float, float, float]]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return A, B, C of modes in parallel, of natural frequency (Hz), damping ratio and gain at rest each."""
    omega = [2 * np.pi * frequency for frequency, _, _ in modes]
    A = block_diag(*[[[0, w], [-w, -2 * z * w]] for w, (_, z, _) in zip(omega, modes, strict=True)])
    B = np.concatenate([[0.0, gain * w] for w, (_, _, gain) in zip(omega, modes, strict=True)])[:, None]
    n = len(A)
    both = expm(np.block([[A, B], [np.zeros((1, n + 1))]]) / RATE)
    return both[:n, :n], both[:n, n:], np.array([[1.0, 0.0] * len(modes)])


def model(axis: str) -> InnovationModel:
    """Return what a perfect identification would give from the inner loop's reference: the mechanics and its lag."""
    return lagging(mechanics(axis), 250.0)


def lagging(system: tuple[np.ndarray, np.ndarray, np.ndarray], corner: float) -> InnovationModel:
    """Return a model of a system behind a first-order lag of so many Hz."""
    A, B, C = system
    pole = np.exp(-2 * np.pi * corner / RATE)
    A = np.block([[A, B], [np.zeros((1, len(A))), np.full((1, 1), pole)]])
    B = np.vstack([np.zeros_like(B), [[1 - pole]]])
    C = np.hstack([C, [[0.0]]])
    return InnovationModel(A, B, C, np.zeros((1, 1)), np.zeros((len(A), 1)), RATE, np.full((1, 1), 1e-16))


def two_near_one_another() -> InnovationModel:
    """Return a plate whose resonance an other axis has split: two lightly damped ones, 2.5 Hz apart."""
    turns = [
        np.exp(2 * np.pi * f / RATE * (1j * np.sqrt(1 - z**2) - z)) for f, z in ((109.34, 0.0074), (111.82, 0.0022))
    ]
    blocks = block_diag(*([[turn.real, turn.imag], [-turn.imag, turn.real]] for turn in turns))
    inlet, outlet = np.array([[-0.156], [0.776], [0.079], [-0.446]]), np.array([[1.0, 0.0, 1.0, 0.0]])
    return InnovationModel(blocks, inlet, outlet, [[0.0]], np.full((4, 1), 0.01), RATE, [[2e-14]])


class LinearStage(Block):
    """Voltage to extension by a first order, extension to position by the modes; noise on both sensors.

    Ports: `voltage` (V), `push` (m, added to the position) in; `position`, `extension` (m) out, of the sample before.
    """

    def __init__(self, axes: tuple[str, ...] = ("x", "y", "z"), factor: float = 1.0, noise: float = 1e-9) -> None:
        width = len(axes)
        self.inputs = (Port("voltage", "V", width), Port("push", "m", width))
        self.outputs = (Port("position", "m", width), Port("extension", "m", width))
        self.parts = [mechanics(axis, factor) for axis in axes]
        self.noise = noise
        self.broken: dict[tuple[str, int], float] = {}

    def prepare(self, rate: float, frames: int) -> None:
        assert (rate, frames) == (RATE, 1)
        self.random = np.random.default_rng(5)
        self.pole = np.exp(-2 * np.pi * LAG / rate)
        self.stretch = np.zeros(len(self.parts))
        self.states = [np.zeros((len(A), 1)) for A, _, _ in self.parts]

    def process(self, voltage: np.ndarray, push: np.ndarray, position: np.ndarray, extension: np.ndarray) -> None:
        for axis, (A, B, C) in enumerate(self.parts):
            self.stretch[axis] += (1 - self.pole) * (VOLTS * voltage[0, axis] - self.stretch[axis])
            self.states[axis] = A @ self.states[axis] + B * self.stretch[axis]
            position[0, axis] = (C @ self.states[axis])[0, 0]
        noise = self.noise * self.random.standard_normal((2, len(self.parts)))
        position[0] += push[0] + noise[0]
        extension[0] = self.stretch + noise[1]
        for (sensor, axis), value in self.broken.items():
            {"position": position, "extension": extension}[sensor][0, axis] = value


class Given(Block):
    """A frame that a test writes."""

    def __init__(self, width: int) -> None:
        self.outputs = (Port("value", "m", width),)
        self.value = np.zeros(width)

    def process(self, value: np.ndarray) -> None:
        value[:] = self.value


class Bench:
    """A closed loop on the linear stage, ticked a sample at a time."""

    def __init__(
        self,
        config: StageConfig,
        controller: StageController,
        plant: LinearStage,
        compensation: Block | None = None,
    ) -> None:
        axes = len(config.stage.axes)
        self.graph = Graph(RATE)
        self.plant, self.reference, self.push = plant, Given(axes), Given(axes)
        self.stage = Stage(self.graph, config, controller, compensation)
        for name, block in (("plant", plant), ("reference", self.reference), ("push", self.push)):
            self.graph.add(name, block)
        self.graph.connect("plant.position", "sensors.position", delayed=True)
        self.graph.connect("plant.extension", "sensors.extension", delayed=True)
        self.graph.connect("reference.value", "controller.reference")
        self.graph.connect("push.value", "plant.push")
        self.graph.connect("guard.voltage", "plant.voltage")
        self.graph.prepare()

    def run(self, seconds: float) -> dict[str, np.ndarray]:
        """Tick so long; return voltage, position and extension reference, shape (samples, axes)."""
        watched = ("guard.voltage", "plant.position", "controller.extension_reference")
        live = {name.partition(".")[2]: self.graph.signal(name) for name in watched}
        kept: dict[str, list[np.ndarray]] = {name: [] for name in live}
        for _ in range(round(seconds * RATE)):
            self.graph.tick()
            for name, frame in live.items():
                kept[name].append(frame[0].copy())
        return {name: np.array(rows) for name, rows in kept.items()}
