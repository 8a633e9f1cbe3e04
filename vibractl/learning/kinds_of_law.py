"""The learning laws by name: what tells one from another, a line each."""

from dataclasses import dataclass

from vibractl.learning.gains import CHIRP_GAINS, KALMAN_GAINS, SINE_GAINS, Gains


@dataclass(frozen=True)
class KindOfLaw:
    """A law, as `learning.law` names it.

    Parameters
    ----------
    gains, tonal_gains : Gains
        Of its updates where the settings give none; of one frequency and its overtones.
    follows : bool
        Whether it follows the plant by the parts of [adaptation], and allows for the ends of a shot; else all of them
        are off.
    by_inverse : bool
        Whether its first drive is G^+ R where `learning.start` leaves that to the law; else the reference, scaled.
    decentralised : bool
        Whether it takes `learning.structure` "decentralised".
    """

    gains: Gains
    tonal_gains: Gains
    follows: bool
    by_inverse: bool
    decentralised: bool


KINDS = {
    "kalman": KindOfLaw(KALMAN_GAINS, KALMAN_GAINS, follows=True, by_inverse=True, decentralised=False),
    "thesis": KindOfLaw(CHIRP_GAINS, SINE_GAINS, follows=False, by_inverse=False, decentralised=True),
}
"""Every value that `learning.law` may have."""
