"""Chapter 8's planner of four directions: a Q of two features, whose weights are learned."""

import numpy as np

from stagectl.planning import features_kernel as kernel
from stagectl.planning.milling import Milled, learned
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Cut, Standing, costs, untouched

LEARNING_RATE = 0.1
DISCOUNT = 1.0
"""alpha and gamma of (8.5) and (8.6)."""
EPISODES, FEW_EPISODES = 100, 10
"""Of the training before a pocket, and of the short one after a duration that was not expected."""


class FeaturesPlanner:
    """Mills in all directions of a pocket by how long a strip takes and how long all will take that begins with it.

    An action is a side, a feed and a k: of the text's 20 milling actions and 12 lifts those that are legal in a
    rectangle, 16 of them in general position.

    Parameters
    ----------
    pocket : Pocket
        What is believed in the beginning.
    seed : int
        Of the weights and of the starts of episodes.

    Source
    ------
    Sörnmo 2015, eqs. (8.3) to (8.12).

    Departs
    -------
    As printed, weights in [-1, 0] and features that are inverse times prefer the slowest strip.  Here F_1 is t(a) and
    F_2 is T_Sigma(a), so that (8.3) to (8.6) hold as printed: Q is minus the time still to be spent, and w_2 goes to
    -1.  Weights are held at most 0.  The text gives no normalizing constants: epsilon_2 is 1 over T_Sigma of the
    untouched pocket and epsilon_1 a hundredth of it, since with equal ones paths are 10 to 20 % longer.

    In (8.9), a_theta holds the first strip of the best pair only; the move to the first strip counts once and is not
    multiplied; and the last four rows or columns are gone through strip by strip.  A strip that stays on its side and
    is not in a_theta has t_d2 for infinity in (8.12), so that one strip more before a turn is considered.
    """

    def __init__(self, pocket: Pocket, seed: int = 0) -> None:
        self._belief = costs(pocket)
        self._random = np.random.default_rng(seed)
        self.weights = -self._random.random(kernel.FEATURES)
        self._values = np.empty((*self._belief.rate.shape, kernel.FEATURES))
        self._is_surprised = False
        self._scale = 1.0
        self._scale = 1.0 / self._features(untouched(pocket))[:, :, 1].min()
        self._train(untouched(pocket), EPISODES)

    def choose(self, standing: Standing) -> Cut:
        """Return the strip to mill next, after a short training if the last duration was not expected."""
        if self._is_surprised:
            self._train(standing, FEW_EPISODES)
            self._is_surprised = False
        _, way, k = kernel.choose(self._features(standing), self.weights)
        return Cut(way, k)

    def learn(self, milled: Milled) -> None:
        """Take a finished segment's duration for that of its strip from now on."""
        newer = learned(self._belief, milled)
        self._is_surprised |= newer is not self._belief
        self._belief = newer

    def _features(self, standing: Standing) -> np.ndarray:
        """Return the features of each strip, shape (ways, tool, 2), 1."""
        kernel.features(standing.way, tuple(standing.uncut), *self._belief, self._scale, self._values)
        return self._values

    def _train(self, standing: Standing, episodes: int) -> None:
        for _ in range(episodes):
            first, learning = int(self._random.integers(1 << 30)), (self._scale, LEARNING_RATE, DISCOUNT)
            kernel.episode(standing.way, tuple(standing.uncut), first, *self._belief, self.weights, learning)
