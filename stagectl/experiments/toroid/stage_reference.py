"""What mid-ranging asks of the stage, within its travel; and the hold when that has been too little for too long."""

from collections.abc import Callable

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.config import Range
from stagectl.experiments.toroid import stage_reference_kernel as kernel


class StageReference(Block):
    """Let the stage's reference through from its middle to either end of its travel; latch a hold when it stays there.

    Ports, three wide: `fast_reference` (m, from the middle) in; `reference` (m, of the plate) and `limited` (one wide:
    samples at an end so far) out.

    Parameters
    ----------
    travel : (float, float), m
    patience : float, s
        At an end of the travel for longer, it tells; infinite for never.
    axes : tuple of str, three names
    hold : callable(reason)
    """

    inputs = (Port("fast_reference", "m", 3),)
    outputs = (Port("reference", "m", 3), Port("limited"))

    def __init__(self, travel: Range, patience: float, axes: tuple[str, ...], hold: Callable[[str], None]) -> None:
        self._middle, self._reach = sum(travel) / 2, (travel[1] - travel[0]) / 2
        self._patience, self._axes, self._hold = patience, axes, hold

    def prepare(self, rate: float, frames: int) -> None:
        """Begin in the middle."""
        self._rate, self._count = rate, np.zeros(4, np.int64)

    def process(self, fast_reference: np.ndarray, reference: np.ndarray, limited: np.ndarray) -> None:
        """Limit one frame."""
        patience = self._patience * self._rate
        axis = kernel.run(fast_reference, reference, limited, self._middle, self._reach, self._count, patience)
        if axis >= 0:
            seconds = self._count[axis] / self._rate
            self._hold(
                f"the stage is at an end of its travel on {self._axes[axis]} for {seconds:.3g} s, must be <= "
                f"{self._patience:g} s"
            )

    @property
    def samples_at_end(self) -> int:
        """In how many samples more was wished for, all axes together."""
        return int(self._count[3])
