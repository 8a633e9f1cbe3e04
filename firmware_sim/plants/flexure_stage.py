"""A stage on flexures driven by stacks: modes, hysteresis and creep of any kind, as its record of numbers says."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants import flexure_stage_kernel as kernel
from firmware_sim.plants import hysteresis_kernel
from firmware_sim.plants.creep import Creep
from firmware_sim.plants.options import refuse_rate
from firmware_sim.plants.stack_hysteresis import Hysteresis


@dataclass(frozen=True)
class Stack:
    """A stack and its amplifier.

    Parameters
    ----------
    voltage : (float, float), V, lowest and highest
    stroke : float, m, of the free stack over that range, less its creep
    curvature : float, 1, by how much of the stroke it is bent, times 4 u (1 - u) over the range u = 0 ... 1
    amplifier, lag : float, Hz, corners of two first-order low-passes in series; infinite for none
    slew : float, V/s
    hysteresis : Hysteresis
    creep : Creep
    """

    voltage: tuple[float, float]
    stroke: float
    curvature: float
    amplifier: float
    lag: float
    slew: float
    hysteresis: Hysteresis
    creep: Creep


@dataclass(frozen=True)
class Guide:
    """What rubs on the plate, by LuGre's model: N/m, N s/m, N s/m, N, N and m/s."""

    bristle: float
    loss: float
    viscous: float
    coulomb: float
    stiction: float
    stribeck: float


@dataclass(frozen=True)
class Modes:
    """What the stacks push.

    Parameters
    ----------
    frequency, damping : arrays, shape (modes,), Hz and 1
    extension, plate : arrays, shape (3, modes), 1/sqrt(kg)
        How a stack's length and the plate move with a mode, scaled to its mass.
    stiffness : array, shape (3,), N/m
        Of the stacks.
    residual : array, shape (3,), 1
        What of its free expansion a stack shows at once, by what is stiffer than all modes.
    """

    frequency: np.ndarray
    damping: np.ndarray
    extension: np.ndarray
    plate: np.ndarray
    stiffness: np.ndarray
    residual: np.ndarray

    def gains(self) -> tuple[np.ndarray, np.ndarray]:
        """Return what stacks and plate move at rest for expansions of one, shape (3, 3) each, row by stack or plate."""
        drive = (self.stiffness[:, None] * self.extension / (2 * np.pi * self.frequency) ** 2).T
        return self.extension @ drive + np.diag(self.residual), self.plate @ drive


@dataclass(frozen=True)
class Sensor:
    """What one kind of sensor makes of three axes.

    Parameters
    ----------
    noise, step : float, m
        White, rms; of its converter.
    range : (float, float), m
    gain : array, shape (3,), 1
    corner : float, Hz, of each of two first-order low-passes in series; infinite for none
    """

    noise: float
    step: float
    range: tuple[float, float]
    gain: np.ndarray
    corner: float


@dataclass(frozen=True)
class FlexureStage:
    """A stage, as numbers.

    Parameters
    ----------
    stacks : tuple of Stack, three, x y z
    guides : tuple of Guide, three, or none
    modes : Modes
    gauge, capacitive, laser : Sensor
    laser_rate : float, Hz
        By which the laser measures.
    delay, laser_delay : int, samples
        Of gauge and capacitive sensor, and of the laser.
    seed : int
        Of the sensors' noise.
    """

    stacks: tuple[Stack, Stack, Stack]
    guides: tuple[Guide, ...]
    modes: Modes
    gauge: Sensor
    capacitive: Sensor
    laser: Sensor
    laser_rate: float
    delay: int
    laser_delay: int
    seed: int


class FlexureStagePlant:
    """Voltages of stacks, forces on the plate and the robot's displacement in; stacks, plate and laser out.

    A free expansion follows its voltage through an amplifier and a lag, hysteresis, curvature and creep; it drives the
    modes through the stack's stiffness, as forces on the plate do, so what loads a stack shows on its gauge.  Friction
    of guides acts on the plate, by its speed at the end of the sample before.  The modes' recursion is exact for forces
    held over a sample.

    It does not model: heat, hysteresis that depends on load, flexures that stiffen with travel, end stops, cross talk
    between sensors, rotations of the plate.

    Parameters
    ----------
    rate : float, samples/s, 2000 to 1e5
    stage : FlexureStage

    Source
    ------
    Where each part stands: `stack_hysteresis`, `hysteresis_kernel`, `creep`; for modes driven by a stack, Preumont,
    Vibration Control of Active Structures, 3rd ed., sec. 4.4.
    """

    def __init__(self, rate: float, stage: FlexureStage) -> None:
        refuse_rate(rate, 2_000, 1e5, "the simulated stage")
        self.stage = stage
        self._arrays = _arrays(stage, rate)

    def run(
        self,
        voltage: np.ndarray,
        force: np.ndarray,
        base: np.ndarray,
        extension: np.ndarray,
        position: np.ndarray,
        absolute: np.ndarray,
    ) -> None:
        """Go on for one frame.

        Parameters
        ----------
        voltage, force, base : arrays, shape (frames, 3), V, N and m
            Of stacks, on the plate, and of the robot; axes x y z.
        extension, position, absolute : arrays, shape (frames, 3), m
            Filled in place: strain gauges, capacitive sensors, and the laser (plate plus robot).
        """
        kernel.run(voltage, force, base, extension, position, absolute, self._arrays)


def _arrays(stage: FlexureStage, rate: float) -> kernel.Stage:
    """Return the kernel's arrays, at rest at the lowest voltages."""
    elements = max(len(stack.hysteresis.threshold) for stack in stage.stacks)
    terms = max(len(stack.creep.rate) for stack in stage.stacks)
    axes, creep = np.zeros(3, kernel.AXIS), np.zeros((3, 2, terms))
    threshold, weight = np.zeros((3, elements)), np.zeros((3, elements))
    axes["step"], axes["residual"] = 1.0 / rate, stage.modes.residual
    for axis, stack in enumerate(stage.stacks):
        own, (low, high), law, crept = axes[axis], stack.voltage, stack.hysteresis, stack.creep
        own["low"], own["reach"], own["slew"] = low, high - low, stack.slew / rate
        own["amplifier"], (own["lag"], own["lag_now"]) = _low_pass(stack.amplifier, rate)[0], _low_pass(stack.lag, rate)
        own["kind"], own["curve"], own["at_once"], own["stroke"] = law.kind, stack.curvature, crept.direct, stack.stroke
        own["hysteresis"] = law.numbers
        if law.kind == hysteresis_kernel.MAXWELL_SLIP:
            own["hysteresis"][hysteresis_kernel.RESISTANCE] *= rate
        threshold[axis, : len(law.threshold)], weight[axis, : len(law.weight)] = law.threshold, law.weight
        creep[axis, :, : len(crept.rate)] = -np.expm1(-crept.rate / rate), crept.share
    for axis, guide in enumerate(stage.guides):
        axes["guide"][axis] = guide.bristle, guide.loss, guide.viscous, guide.coulomb, guide.stiction, guide.stribeck
    rng = np.random.default_rng([stage.seed, 3])
    return kernel.Stage(
        axes=axes, threshold=threshold, weight=weight, creep=creep, table=_table(stage.modes, rate),
        sensors=_sensors(stage, rate), elements=np.zeros((3, elements)), crept=np.zeros((3, terms)),
        motion=np.zeros((2, len(stage.modes.frequency))), line=np.zeros((stage.delay + 1, 6)),
        late=np.zeros((stage.laser_delay + 1, 3)),
        lines=np.array([(0, 0, min(stage.laser_rate / rate, 1.0), 0.0)], kernel.LINES),
        random=rng.integers(1, 2**63, 1, np.uint64),
    )  # fmt: skip


def _low_pass(corner: float, rate: float) -> tuple[float, float]:
    """Return a low-pass' pole and what it takes of a sample's end; exact for an input that goes straight."""
    decay = 2 * np.pi * corner / rate
    pole = np.exp(-decay)
    return float(pole), float(1.0 - (1.0 - pole) / decay)


def _table(modes: Modes, rate: float) -> np.ndarray:
    """Return the kernel's table of recursion and shapes, shape (17, modes)."""
    step, omega = 1 / rate, 2 * np.pi * modes.frequency
    decay = modes.damping * omega
    ringing = omega * np.sqrt(1 - modes.damping**2)
    shrink, cosine, sine = np.exp(-decay * step), np.cos(ringing * step), np.sin(ringing * step) / ringing
    free = shrink * (cosine + decay * sine)
    recursion = [free, shrink * sine, -(omega**2) * shrink * sine, shrink * (cosine - decay * sine)]
    shapes = [modes.stiffness[:, None] * modes.extension, modes.plate, modes.extension, modes.plate]
    return np.vstack([*recursion, (1 - free) / omega**2, *shapes])


def _sensors(stage: FlexureStage, rate: float) -> np.ndarray:
    """Return the kernel's table of sensors, shape (3, 3)."""
    table = np.zeros((3, 3), kernel.SENSOR)
    for row, each in zip(table, (stage.gauge, stage.capacitive, stage.laser), strict=True):
        row["rms"], row["resolution"], (row["bottom"], row["top"]) = each.noise, each.step, each.range
        row["gain"], (row["filter"], row["now"]) = each.gain, _low_pass(each.corner, rate)
    return table
