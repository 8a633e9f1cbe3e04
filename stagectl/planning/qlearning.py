"""Chapter 8's planner of two directions: Q-learning over rows, feeds and sides, taught anew after each segment."""

import numpy as np

from stagectl.planning import qlearning_kernel as kernel
from stagectl.planning.milling import Milled, learned
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Cut, Standing, costs

LEARNING_RATE = 1.0
"""alpha: rewards are certain, so that the newest value is the best one."""
DISCOUNT = 1.0
"""gamma: a second at the end of the pocket is as long as one now."""


class QLearningPlanner:
    """Mills in two directions by a Q that random transitions taught.

    There are 4 N + 1 states: the row down to (or up to) which a side is milled, the feed that was last, the side, and
    the one in which the tool stands, from which alone the side may be changed.  The training begins with the Q of the
    segment before.

    Parameters
    ----------
    pocket : Pocket
        What is believed in the beginning.
    seed : int
        Of the random transitions.

    Source
    ------
    Sörnmo 2015, eqs. (8.1) and (8.2), fig. 8.1.

    Departs
    -------
    The start state is where the tool stands, so that the change of side needs no rule of its own.  Only the types east
    and west are milled, in any pocket.
    """

    def __init__(self, pocket: Pocket, seed: int = 0) -> None:
        self._belief = costs(pocket)
        self._seed = seed
        shape = (4 * pocket.rows + 1, kernel.TWO_DIRECTIONS * pocket.G)
        self._quality = np.zeros(shape)
        self._reward, self._follows = np.empty(shape), np.empty(shape, np.int64)
        self.transitions = 0
        """How many were drawn in the latest training."""

    def choose(self, standing: Standing) -> Cut:
        """Return the strip to mill next."""
        kernel.rewards(standing.way, tuple(standing.uncut), *self._belief, self._reward, self._follows)
        self.transitions = kernel.train(
            self._reward, self._follows, self._quality, LEARNING_RATE, DISCOUNT, self._seed + len(self._quality)
        )
        here = np.where(np.isfinite(self._reward[-1]), self._quality[-1], -np.inf)
        way, k = divmod(int(np.argmax(here)), self._belief.rate.shape[1])
        return Cut(way, k + 1)

    def learn(self, milled: Milled) -> None:
        """Take a finished segment's duration for that of its strip from now on."""
        self._belief = learned(self._belief, milled)
