"""Oak under the tool of a robot on its wires, in place of a block of aluminium."""

import numpy as np

from firmware_sim.plants.oak import OakMilling


class WiredOak:
    """A piece of oak with the outputs of `PocketMilling`: what its kappa and beta are nobody is told.

    Parameters
    ----------
    oak : OakMilling
    """

    def __init__(self, oak: OakMilling) -> None:
        self.oak, self.rate = oak, oak.rate
        self._kappa, self._beta = np.zeros((1, 1)), np.zeros((1, 1))

    def run(
        self, tool: np.ndarray, give: np.ndarray, force: np.ndarray, moment: np.ndarray, teeth_force: np.ndarray
    ) -> None:
        """Go on for one sample.

        Parameters
        ----------
        tool : array, shape (1, 3), m
            Where the tip really is, in axes of the base.
        give : array, shape (1, 9), m/N
            Not needed: the force of oak answers where the tool is, not how fast it comes.
        force, moment, teeth_force : arrays, shape (1, 3), N, N m and N, filled in place
            On the tool, averaged over a turn and with its teeth.
        """
        self.oak.run(tool, force, moment, teeth_force, self._kappa, self._beta)
