"""Faint records by which a quiet calibration finds out how sensitive a machine is, before it is loud anywhere."""

from dataclasses import replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from calibration.emission_limit import EmissionLimit
from calibration.multisine import Design
from calibration.multisine_estimate import Spectra

SHARE = 0.3
"""Of what is allowed: the loudest line of a probe or of the scout."""
STRONGEST = 1e5
"""m/s^2 per V, of all coils together: |G| that the first probe reckons with."""
LOUDER, MOST_LOW = 30.0, 5
"""Times a probe of the lines without a limit is louder than one before that was not heard; and how many there are."""
PEAK, LOW_PEAK = 50.0, 3.0
"""Times what those lines have shown, rms, that |G| is reckoned to be at most elsewhere, and at them: of 150
drawn vibrators it is more than 34 on 5 %, and 107 on one."""
BOLDER, MOST = (3.0, 10.0), 3
"""Times a probe of all lines is louder than the one before that was not heard, by what may be hidden in the ambience;
and how many there are."""
MOST_STUCK = 5
"""Of these where the lines without a limit were not heard."""
LOW = -30.0
"""dB re the reference's own lines, of lines below 100 Hz, for which there is no limit: their overtones have one."""
HEARD_LOW, HEARD = 4.0, 10.0
"""Times the power of the lines between the excited ones, of the same record, that theirs is where a response is beyond
doubt: of all lines without a limit together, and of some lines side by side."""
FEW = 0.9
"""Part of the lines whose ambience is reckoned with: those of hum are left out."""
TOGETHER = 9.0
"""Excited lines that are taken together: the width of a resonance."""
_TINY = np.finfo(float).tiny


class UnheardError(ValueError):
    """Nothing of the drives is heard."""


class Probes:
    """How loud the next probe is; when it is `done`, how loud the scout.

    The first ones are of the lines below 100 Hz, for which there is no limit: they show the rig's gain.  From there
    |G| is known to two orders of magnitude everywhere, and the next ones are of all lines.

    Parameters
    ----------
    design : Design
        Of the scout.
    limit : EmissionLimit
    """

    def __init__(self, design: Design, limit: EmissionLimit) -> None:
        frequency = design.frequency
        self._base, self._allowed = design, SHARE * limit.allowed(frequency, LOW)
        self._low = limit.is_free(frequency)
        self._at_low, self._elsewhere = (STRONGEST, np.inf) if self._low.any() else (np.inf, STRONGEST)
        self._made, self._is_heard, self.done = 0, False, False

    @property
    def scout(self) -> Design:
        """All records at the present level."""
        size = self._allowed / np.where(self._low, self._at_low, self._elsewhere)
        return replace(self._base, amplitude=np.tile(size[:, None], self._base.amplitude.shape[1]))

    @property
    def design(self) -> Design:
        """The next probe: one record."""
        return replace(self.scout, records=1)

    def take(self, spectra: Spectra) -> None:
        """Go on from what was heard of `design`.

        Raises
        ------
        UnheardError : the last probe was not heard either.
        """
        self._made += 1
        heard, excited = np.abs(spectra.response[0]) ** 2, self._base.bins - spectra.first
        if np.isinf(self._elsewhere):
            self._take_low(*_powers(heard, excited[self._low]))
        else:
            self._take_all(heard[excited[~self._low]], *_powers(heard, excited[~self._low]))

    def _take_low(self, power: np.ndarray, between: np.ndarray) -> None:
        if np.median(power / np.maximum(between, _TINY), axis=0).max() > HEARD_LOW:
            drive = (self._allowed[self._low] / self._at_low)[:, None]
            gain = float(np.sqrt(np.mean(power / drive**2, axis=0)).max())
            self._at_low, self._elsewhere, self._made, self._is_heard = LOW_PEAK * gain, PEAK * gain, 0, True
        elif self._made < MOST_LOW:
            self._at_low /= LOUDER
        else:  # joints that stick below; what is as little sensitive above may still be heard there
            self._elsewhere, self._made = PEAK * self._at_low, 0

    def _take_all(self, heard: np.ndarray, power: np.ndarray, between: np.ndarray) -> None:
        allowed = self._allowed[~self._low, None] ** 2
        is_beyond_doubt = power > HEARD * between
        if is_beyond_doubt.any():
            self._elsewhere *= float(np.sqrt((np.where(is_beyond_doubt, heard, 0.0) / allowed).max()))
        elif self._made < (MOST if self._is_heard else MOST_STUCK):
            hidden = float(np.quantile(HEARD * np.where(np.isinf(between), 0.0, between) / allowed, FEW))
            self._elsewhere /= float(np.clip(1 / np.sqrt(max(hidden, _TINY)), *BOLDER))
            return
        elif not self._is_heard:
            raise UnheardError(
                f"quiet calibration: drives of {self.design.amplitude.max():.2g} V per bin reach no response; "
                "are amplifier and sensors on?"
            )
        self.done = True


def _powers(power: np.ndarray, excited: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean power of the excited lines around each of them, and of those between, both (lines, outputs).

    Near the ends of the band what lies between counts as infinite.
    """
    mask = np.zeros((len(power), 1))
    around = round(TOGETHER * (excited[-1] - excited[0] + 1) / len(excited))
    mask[excited] = 1.0
    means = []
    for which in (mask, 1.0 - mask):
        share = np.maximum(uniform_filter1d(which, around, axis=0, mode="constant"), _TINY)
        means.append(uniform_filter1d(which * power, around, axis=0, mode="constant") / share)
    ends = uniform_filter1d(np.ones(len(power)), around, mode="constant") < 0.99
    means[1][ends] = np.inf  # too few lines there to tell
    return means[0][excited], means[1][excited]
