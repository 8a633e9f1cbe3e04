"""A macro and a micro manipulator that share one position: the pair of loops of Sörnmo 2015, eq. (3.13)."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from firmware_sim.plants.options import option, refuse_wrong_options
from rigkit.compiled import njit

PAIR = np.dtype(
    [
        ("inner_gain", "f8"),  # 1/s
        ("limit", "f8"),  # m/s
        ("process_gain", "f8"),  # m a sample for m/s
        ("pole", "f8"),  # of the macro manipulator
        ("noise", "f8"),  # m
        ("disturbed", "f8"),  # samples
        ("disturbance", "f8"),  # m
        # state
        ("fast", "f8"),  # m
        ("slow", "f8"),  # m
        ("done", "i8"),  # samples
    ],
    align=True,
)


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
        disturbed = round(made.disturbed_at * rate), made.disturbance
        numbers = made.inner_gain, made.limit, made.process_gain / rate, pole, made.noise, *disturbed, 0.0, 0.0, 0
        self._pair = np.array([numbers], PAIR)
        self._changes = np.array([[round(time * rate), gain] for time, gain in made.gains]).reshape(-1, 2)
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
        asked = fast_reference[:, 0], slow_reference[:, 0]
        shown = relative[:, 0], fast[:, 0], slow[:, 0], control[:, 0], position[:, 0]
        _run(asked, shown, self._changes, self._pair, self._random)


@njit(cache=True, nogil=True)
def _run(
    asked: tuple[np.ndarray, ...],
    shown: tuple[np.ndarray, ...],
    changes: np.ndarray,
    pairs: np.ndarray,
    random: np.random.Generator,
) -> None:
    (wanted, slow_wanted), (relative, fast, slow, control, position), pair = asked, shown, pairs[0]
    limit, pole, noise = pair.limit, pair.pole, pair.noise
    for n in range(len(wanted)):
        gain = pair.process_gain
        for row in range(len(changes)):
            if pair.done >= changes[row, 0]:
                gain = pair.process_gain * changes[row, 1]
        signal = pair.inner_gain * (wanted[n] - pair.fast)
        pair.fast = flushed(pair.fast + gain * min(max(signal, -limit), limit))
        pair.slow = flushed(pole * pair.slow + (1.0 - pole) * slow_wanted[n])
        pair.done += 1
        position[n] = pair.fast + pair.slow + (pair.disturbance if pair.done >= pair.disturbed else 0.0)
        control[n] = signal
        relative[n] = position[n] + noise * random.standard_normal()
        fast[n] = pair.fast + noise * random.standard_normal()
        slow[n] = pair.slow + noise * random.standard_normal()
