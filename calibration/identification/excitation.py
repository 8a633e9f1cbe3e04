"""Whether inputs excite a model's elements apart from each other, before anything is identified from them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calibration.collinearity import TOGETHER, in_own_units, together
from calibration.stretches import stretches
from calibration.welch import spectra

LENGTH, SHORTEST = 128, 16
"""Samples of a segment: about as many as the horizons reach over, the memory of a model; at least ..."""
SEGMENTS = 32
"""... and segments that there are to be; with fewer, chance makes inputs look alike."""
EXCITED = 1e-4
"""Of an input's strongest bin, in power, from where on it is looked at."""
INSEPARABLE = 1e-6
"""The weakest combination of inputs over the strongest, in power, below which no noise is small enough: errors are 500
times those with independent inputs."""
NEARLY_ALL = 0.95
"""Of the bins that inputs share, in which they must go together to be refused."""
INVOLVED = 0.1
"""Of the largest coefficient of the weakest combination, from where on an input belongs to it."""
SHOWN = 3
"""Bands that are named."""


@dataclass(frozen=True)
class Nearly:
    """A band in which inputs nearly go together.

    Parameters
    ----------
    low, high : float, Hz
    share : float, 1
        The weakest combination over the strongest, in power, where it is least.
    inputs : tuple of str
    """

    low: float
    high: float
    share: float
    inputs: tuple[str, ...]

    @property
    def text(self) -> str:
        """It in words."""
        return f"{self.low:.4g} to {self.high:.4g} Hz ({' and '.join(self.inputs)}, {self.share:.1e})"


def nearly_collinear(drives: Sequence[np.ndarray], rate: float, names: Sequence[str]) -> tuple[Nearly, ...]:
    """Find the bands in which inputs nearly go together; refuse inputs that do so everywhere.

    Each bin of the inputs' spectra by Welch's method has a weakest combination of inputs.  Where its power is a small
    part r of the strongest one's, the elements' errors are (1 + r) / (2 sqrt(r)) times those with independent inputs.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), any unit
        Of each recording.
    rate : float, samples/s
    names : sequence of str
        Of the inputs.

    Raises
    ------
    ValueError : inputs that cannot be told apart.
    """
    length = _length([len(each) for each in drives])
    if len(names) <= 1 or length < SHORTEST:
        return ()
    estimated = spectra(list(drives), list(drives), rate, rate / length)
    power, frequency = estimated.drive[1:], estimated.frequency[1:]
    own = np.real(np.einsum("bmm->bm", power))
    excited = own > EXCITED * own.max(axis=0)
    share = np.array([_share(each, there) for each, there in zip(power, excited, strict=True)])
    shared = np.isfinite(share)
    if shared.any() and np.mean(share[shared] < INSEPARABLE) >= NEARLY_ALL:
        _refuse(power[shared], excited[shared], share[shared], names)
    step = frequency[0]
    return tuple(
        Nearly(
            float(frequency[first] - step / 2),
            min(float(frequency[last - 1] + step / 2), rate / 2),
            float(share[first:last].min()),
            _involved(power[first:last].sum(axis=0), names),
        )
        for first, last in stretches(np.where(shared, share, 1.0) < TOGETHER)
    )


def excitation_notes(nearly: Sequence[Nearly]) -> list[str]:
    """Return a sentence on bands in which inputs nearly go together; none where there are none.

    Parameters
    ----------
    nearly : sequence of Nearly
    """
    if not nearly:
        return []
    least = min(each.share for each in nearly)
    more = f" and {len(nearly) - SHOWN} bands more" if len(nearly) > SHOWN else ""
    return [
        f"warning: inputs nearly go together at {', '.join(each.text for each in nearly[:SHOWN])}{more}: errors of "
        f"single elements are up to {0.5 / np.sqrt(max(least, 1e-300)):.0f} times those with independent inputs there "
        f"(the weakest combination has less than {TOGETHER:g} of the strongest one's power)"
    ]


def _length(samples: Sequence[int]) -> int:
    """Return the samples of a segment, of which half overlap: fewer than `LENGTH` where records are short."""
    return min(LENGTH, min(samples), 2 * sum(samples) // (SEGMENTS + len(samples)))


def _share(power: np.ndarray, excited: np.ndarray) -> float:
    """Return the weakest combination of the excited inputs over the strongest; infinite for a single one."""
    if np.count_nonzero(excited) < 2:
        return np.inf
    return float(together(power[np.ix_(excited, excited)]))


def _involved(power: np.ndarray, names: Sequence[str]) -> tuple[str, ...]:
    """Return the inputs that the weakest combination is of."""
    weakest = np.abs(np.linalg.eigh(in_own_units(power))[1][:, 0])
    return tuple(name for name, size in zip(names, weakest, strict=True) if size > INVOLVED * weakest.max())


def _refuse(power: np.ndarray, excited: np.ndarray, share: np.ndarray, names: Sequence[str]) -> None:
    both = excited.all(axis=1)
    chosen = power[both] if both.any() else power
    involved = _involved(in_own_units(chosen).sum(axis=0), names)
    raise ValueError(
        f"inputs {' and '.join(involved)} are not distinguishable: their weakest combination has "
        f"{np.median(share):.1e} of the strongest one's power, must have >= {INSEPARABLE:g}: drive them by "
        "independent signals or one after the other, or leave one out"
    )
