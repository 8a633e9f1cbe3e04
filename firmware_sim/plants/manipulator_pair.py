"""A macro and a micro manipulator that share one position, as their record of numbers says."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from firmware_sim.plants import manipulator_pair_kernel as kernel
from firmware_sim.plants.options import refuse_rate

STEP = 2.5e-4
"""s, longest within."""


@dataclass(frozen=True)
class Macro:
    """The macro manipulator: guided motion, then an arm.

    Parameters
    ----------
    dead_time : float, s
    corner : float, Hz, of guided motion's own filter
    filters : int, 1 or 2 first-order low-passes of it in series
    speed : float, m/s, fastest
    poles : tuple of complex, rad/s
        Of the arm; its gain at rest is one.
    mode, damping : float, Hz and 1
    share : float, 1
        Of its motion goes by the mode; 0 for none.
    """

    dead_time: float
    corner: float
    filters: int
    speed: float
    poles: tuple[complex, ...]
    mode: float
    damping: float
    share: float


@dataclass(frozen=True)
class Micro:
    """The micro manipulator: a proportional controller that saturates, and a process behind a lag.

    Parameters
    ----------
    inner_gain : float, 1/s
    limit : float, m/s, of the control signal
    process_gain : float, 1/s per m/s
    lag : float, s
    mode, damping, share : as of `Macro`
    stop : float, m, to either side of its middle
    """

    inner_gain: float
    limit: float
    process_gain: float
    lag: float
    mode: float
    damping: float
    share: float
    stop: float


@dataclass(frozen=True)
class ManipulatorPair:
    """A pair, as numbers.

    Parameters
    ----------
    macro : Macro
    micro : Micro
    noise : (float, float, float), m
        Rms, white, of the sensors of relative, fast and slow position.
    seed : int
        Of that noise.
    """

    macro: Macro
    micro: Micro
    noise: tuple[float, float, float]
    seed: int


class ManipulatorPairPlant:
    """Both references in, all positions and the control signal out, sample by sample.

    A slow reference waits for the dead time, passes the filter and the limit of speed, and leads the arm: lags or an
    oscillation, and a mode beside them.  A fast one goes to the inner loop, whose control signal saturates; behind a
    lag it moves the process, which integrates up to its stops, and a mode rings beside it.  Linear parts are exact for
    what is held over a step of at most 0.25 ms.

    It does not model: quantization, friction and backlash, any coupling of one manipulator to the other.

    Parameters
    ----------
    rate : float, samples/s, 10 to 10 000
    pair : ManipulatorPair
    gains : sequence of (float, float), s and 1
        From when on the process gain is which multiple of its own.
    disturbance, disturbed_at : float, m and s
        A step of the relative position, and when it comes.
    """

    def __init__(
        self,
        rate: float,
        pair: ManipulatorPair,
        gains: Sequence[tuple[float, float]] = (),
        disturbance: float = 0.0,
        disturbed_at: float = 0.0,
    ) -> None:
        refuse_rate(rate, 10, 10_000, "the simulated pair")
        steps = max(1, int(np.ceil(1.0 / (rate * STEP) - 1e-9)))
        step, macro, micro = 1.0 / (rate * steps), pair.macro, pair.micro
        own, arm = np.zeros(1, kernel.OWN), _arm(macro, step)
        own["steps"], own["filter"], own["filters"] = steps, np.exp(-2 * np.pi * macro.corner * step), macro.filters
        own["fastest"], own["inner"], own["limit"] = macro.speed * step, micro.inner_gain, micro.limit
        own["process"], own["lag"], own["stop"] = micro.process_gain * step, np.exp(-step / micro.lag), micro.stop
        own["share"], own["disturbed"], own["disturbance"] = micro.share, round(disturbed_at * rate), disturbance
        self._arrays = kernel.Pair(
            own=own, arm=arm, mode=_mode(micro.mode, micro.damping, step), noise=np.array(pair.noise),
            gains=np.array([[round(time * rate), gain] for time, gain in gains]).reshape(-1, 2),
            line=np.zeros(round(macro.dead_time / step) + 1), moved=np.zeros(len(arm)), ringing=np.zeros(2),
        )  # fmt: skip
        self._random = np.random.default_rng([pair.seed, 4])

    def run(
        self,
        fast_reference: np.ndarray,
        slow_reference: np.ndarray,
        relative: np.ndarray,
        fast: np.ndarray,
        slow: np.ndarray,
        control: np.ndarray,
        position: np.ndarray,
    ) -> None:
        """Move the pair over one frame.

        Parameters
        ----------
        fast_reference, slow_reference : array, shape (frames, 1), m
        relative, fast, slow : array, shape (frames, 1), m
            Filled with what the sensors show at the end of each sample.
        control : array, shape (frames, 1), m/s
            Filled with the micro manipulator's control signal as each sample begins, ahead of its saturation.
        position : array, shape (frames, 1), m
            Filled with the relative position itself at the end of each sample.
        """
        asked = fast_reference[:, 0], slow_reference[:, 0]
        shown = relative[:, 0], fast[:, 0], slow[:, 0], control[:, 0], position[:, 0]
        kernel.run(asked, shown, self._arrays, self._random)


def _arm(macro: Macro, step: float) -> np.ndarray:
    """Return the macro manipulator's arm as the kernel has it, shape (n, n + 2)."""
    polynomial = np.real(np.poly(macro.poles))
    order = len(macro.poles)
    states = order + (2 if macro.share else 0)
    a, b, c = np.zeros((states, states)), np.zeros(states), np.zeros(states)
    a[: order - 1, 1:order] = np.eye(order - 1)
    a[order - 1, :order] = -polynomial[:0:-1]
    b[order - 1], c[0] = polynomial[-1], 1.0 - macro.share
    if macro.share:
        omega = 2 * np.pi * macro.mode
        a[order, order + 1], a[order + 1, 0] = 1.0, omega**2
        a[order + 1, order:] = -(omega**2), -2 * macro.damping * omega
        c[order] = macro.share
    held, entered = _held(a, b, step)
    return np.column_stack([held, entered, c])


def _mode(frequency: float, damping: float, step: float) -> np.ndarray:
    """Return a mode of gain one at rest as the kernel has it, shape (2, 3)."""
    omega = 2 * np.pi * frequency
    held, entered = _held(np.array([[0.0, 1.0], [-(omega**2), -2 * damping * omega]]), np.array([0.0, omega**2]), step)
    return np.column_stack([held, entered])


def _held(a: np.ndarray, b: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Return both matrices of a system whose input is held over a step, (n, n) and (n,)."""
    order = len(a)
    whole = np.zeros((order + 1, order + 1))
    whole[:order, :order], whole[:order, order] = a, b
    both = expm(step * whole)
    return both[:order, :order], both[:order, order]
