"""A pocket as an environment of gymnasium, for learners of other kinds (the extra `gym`)."""

from typing import Any

import numpy as np

from stagectl.planning.problem import Pocket
from stagectl.planning.strips import NO_WAY, Cut, after, costs, cutting, legal, moving, untouched

try:
    import gymnasium
    from gymnasium.spaces import Box, Discrete
except ImportError as fault:
    raise ImportError(f"gymnasium is not there ({fault}): pip install 'vibrostage[gym]'") from None

PATIENCE = 4
"""Steps per row and column after which an episode is cut short."""

Seen = np.ndarray[Any, np.dtype[np.float32]]


class PocketEnv(gymnasium.Env[Seen, np.int64]):
    """Mill a pocket strip by strip; the return of an episode is minus its time, s, at what is really paid.

    An action is a side, a feed and a k, `strips.Cut(*divmod(action, G))` with k from 0.  `info["action_mask"]`, shape
    (actions,), 1, says which are legal; an illegal one changes nothing and costs the longest strip and lift there is.

    An observation, shape (4 + ways + 1,), 1, is the uncut rectangle by rows and columns, and which way was last.

    Parameters
    ----------
    pocket : Pocket
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012  # gymnasium's own

    def __init__(self, pocket: Pocket) -> None:
        self._cost = costs(pocket.paid())
        self._pocket = pocket
        ways, tool = self._cost.rate.shape
        self._actions = ways * tool
        self.action_space = Discrete(self._actions)
        self.observation_space = Box(0.0, 1.0, (4 + ways + 1,), np.float32)
        self._size = np.array([pocket.rows, pocket.rows, pocket.cols, pocket.cols], np.float32)
        longest = float(self._cost.rate.max()) * max(pocket.rows, pocket.cols)
        self._penalty = self._cost.begin + longest + float(self._cost.moves[1].max())
        self._standing, self._steps = untouched(pocket), 0

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Seen, dict[str, Any]]:
        """Begin with the untouched pocket; nothing is drawn, and there are no options."""
        super().reset(seed=seed, options=options)
        self._standing, self._steps = untouched(self._pocket), 0
        return self._seen(), self._told()

    def step(self, action: np.int64) -> tuple[Seen, float, bool, bool, dict[str, Any]]:
        """Mill a strip.

        Raises
        ------
        ValueError : the pocket is milled already, or there is no such action.
        """
        if self._standing.is_done:
            raise ValueError("the pocket is milled, must be reset first")
        if not self.action_space.contains(action):
            raise ValueError(f"action is {action}, must be 0 to {self._actions - 1}")
        self._steps += 1
        reward = -self._penalty
        if self._told()["action_mask"][action]:
            cut = self._cut(int(action))
            reward = -moving(cut, self._standing, self._cost) - cutting(cut, self._standing, self._cost)
            self._standing = after(cut, self._standing)
        is_cut_short = self._steps >= PATIENCE * (self._pocket.rows + self._pocket.cols)
        done = self._standing.is_done
        return self._seen(), reward, done, is_cut_short and not done, self._told()

    def _cut(self, action: int) -> Cut:
        way, k = divmod(action, self._pocket.G)
        return Cut(way, k + 1)

    def _seen(self) -> Seen:
        ways = np.zeros(self.observation_space.shape[0] - 4, np.float32)  # type: ignore[index]  # a Box has one
        ways[self._standing.way if self._standing.way != NO_WAY else -1] = 1.0
        return np.concatenate([np.array(self._standing.uncut, np.float32) / self._size, ways])

    def _told(self) -> dict[str, Any]:
        mask = np.zeros(self._actions, np.int8)
        if not self._standing.is_done:
            for cut in legal(self._standing, self._cost):
                mask[cut.way * self._pocket.G + cut.k - 1] = 1
        return {"action_mask": mask}
