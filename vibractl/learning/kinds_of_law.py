"""The learning laws by name: what tells one from another, a line each."""

from dataclasses import dataclass

from vibractl.learning.gains import CHIRP_GAINS, KALMAN_GAINS, SINE_GAINS, Gains
from vibractl.learning.laws import ByInverse, ByScaledReference, VibratorLaw


@dataclass(frozen=True)
class KindOfLaw:
    """A law, as `learning.law` names it.

    Parameters
    ----------
    about : str
        What tells it from others, behind its name.
    law : VibratorLaw
        Its first drive where `learning.start` leaves that to the law, and the next ones.
    gains, tonal_gains : Gains
        Of its updates where the settings give none; of one frequency and its overtones.
    follows : bool
        Whether it follows the plant by the parts of [adaptation], and allows for the ends of a shot; else all of them
        are off.
    decentralised : bool
        Whether it takes `learning.structure` "decentralised".
    """

    about: str
    law: VibratorLaw
    gains: Gains
    tonal_gains: Gains
    follows: bool = False
    decentralised: bool = False


KINDS = {
    "kalman": KindOfLaw(
        "follows G from shot to shot, see [adaptation]", ByInverse(), KALMAN_GAINS, KALMAN_GAINS, follows=True
    ),
    "thesis": KindOfLaw("keeps the model", ByScaledReference(), CHIRP_GAINS, SINE_GAINS, decentralised=True),
}
"""Every value that `learning.law` may have."""
