"""The edges of a drive, in what is learned: a line with edges is heard at its neighbours, too."""

from dataclasses import replace

import numpy as np

from vibractl.learning.kinds_of_law import KINDS
from vibractl.learning.law import Law, first_law
from vibractl.learning.laws import ByInverse
from vibractl.learning.variation import Variation, solved


def with_edges(law: Law, edge: float, rest: float, importance: np.ndarray | float) -> Law:
    """Return a law whose drives have edges, and whose first drive allows for them.

    Parameters
    ----------
    law : Law
    edge, rest : float, s
        The drive's raised cosines at both ends, and how long it rests then until the frame's end.
    importance : array, shape (lines,), or float, 1
        How much a line counts where one is better only as another is worse.
    """
    law = replace(law, edge=edge, rest=rest, importance=importance)
    if law.is_tonal or not KINDS[law.settings.law].follows or type(first_law(law.settings)) is not ByInverse:
        return law
    variation = Variation(law.matrix.frequency, edge, rest, None)
    start = solved(law.matrix.response, variation, law.inverse, law.reference, law.weight)
    return replace(law, start=start)
