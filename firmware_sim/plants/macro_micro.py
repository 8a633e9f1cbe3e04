"""A macro and a micro manipulator that share one position: the pair of loops of Sörnmo 2015, eq. (3.13)."""

from dataclasses import dataclass

import numpy as np
from numba import njit

from firmware_sim.plants.flush_kernel import flushed
from firmware_sim.plants.options import option, refuse_wrong_options


@dataclass(eq=False, kw_only=True)
class MacroMicroOptions:
    """Which pair, and what happens to it.

    Parameters
    ----------
    seed : int
        Of the sensors' noise.
    noise : float, m
        Standard deviation of each of the three positions' sensors, white.
    inner_gain : float, 1/s
        H_c^f: of the micro manipulator's controller, a proportional one.
    process_gain : float, 1/s per m/s
        H_o^f: of its process, an integrator.
    limit : float, m/s
        Where the micro manipulator's control signal saturates.
    time_constant : float, s
        Of the macro manipulator's closed loop.
    gains : list of [float s, float]
        From when on the micro manipulator's process gain is which multiple of `process_gain`.
    disturbance, disturbed_at : float, m and s
        Size of a step in the relative position, and when it comes.

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    seed: int = option(1, "", 0)
    noise: float = option(0.0, "m", 0.0, 1.0)
    inner_gain: float = option(5.0, "1/s", 1e-3, 1e3)
    process_gain: float = option(2.0, "1", 1e-3, 1e3)
    limit: float = option(10e-3, "m/s", 1e-9, 1e3)
    time_constant: float = option(1.0, "s", 1e-3, 1e3)
    gains: tuple[tuple[float, float], ...] = ()
    disturbance: float = option(0.0, "m", -10.0, 10.0)
    disturbed_at: float = option(0.0, "s", 0.0)

    def __post_init__(self) -> None:
        """Refuse a wrong option here and now."""
        refuse_wrong_options(self)
        for time, gain in self.gains:
            if not (time >= 0.0 and 0.0 < gain < np.inf):
                raise ValueError(f"simulator.options.gains has {gain!r} at {time!r} s, must be > 0 at >= 0 s")


class MacroMicroPlant:
    """The pair, sample by sample, exact for references held over a sample; options: those of `MacroMicroOptions`.

    The micro loop: u = inner_gain (w - y_f), which saturates; y_f integrates what is left of it.  The macro loop: of
    first order.  The relative position is the sum of both and of the disturbance.

    Not modelled: flexible modes, delays, quantization, saturation of the macro manipulator, friction and backlash, any
    coupling of one manipulator to the other, and noise on what the inner loops measure.

    Parameters
    ----------
    rate : float, samples/s
    **options
        Of `MacroMicroOptions`.
    """

    def __init__(self, rate: float, **options: object) -> None:
        made = MacroMicroOptions(**options)  # type: ignore[arg-type]
        pole = np.exp(-1.0 / (made.time_constant * rate))
        self._constants = np.array([made.inner_gain, made.limit, made.process_gain / rate, pole, made.noise])
        self._changes = np.array([[round(time * rate), gain] for time, gain in made.gains]).reshape(-1, 2)
        self._step = np.array([round(made.disturbed_at * rate), made.disturbance])
        self._state = np.zeros(3)
        self._random = np.random.default_rng(made.seed)

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
            Filled with the micro manipulator's control signal during each sample, ahead of its saturation.
        position : array, shape (frames, 1), m
            Filled with the relative position itself at the end of each sample.
        """
        _run(fast_reference[:, 0], slow_reference[:, 0], relative[:, 0], fast[:, 0], slow[:, 0], control[:, 0],
             position[:, 0], self._constants, self._changes, self._step, self._state, self._random)  # fmt: skip


@njit(cache=True, nogil=True)
def _run(wanted, slow_wanted, relative, fast, slow, control, position, constants, changes, step, state, random):  # type: ignore[no-untyped-def]
    inner_gain, limit, process_gain, pole, noise = constants
    for n in range(len(wanted)):
        gain = process_gain
        for row in range(len(changes)):
            if state[2] >= changes[row, 0]:
                gain = process_gain * changes[row, 1]
        signal = inner_gain * (wanted[n] - state[0])
        state[0] = flushed(state[0] + gain * min(max(signal, -limit), limit))
        state[1] = flushed(pole * state[1] + (1.0 - pole) * slow_wanted[n])
        state[2] += 1.0
        position[n] = state[0] + state[1] + (step[1] if state[2] >= step[0] else 0.0)
        control[n] = signal
        relative[n] = position[n] + noise * random.standard_normal()
        fast[n] = state[0] + noise * random.standard_normal()
        slow[n] = state[1] + noise * random.standard_normal()
