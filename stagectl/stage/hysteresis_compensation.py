"""A block before the stacks that makes modelled actuators look straight."""

from collections.abc import Sequence

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.stage import hysteresis_kernel as kernel
from stagectl.stage.hysteresis import HysteresisModel


class HysteresisCompensation(Block):
    """Ask the stacks for the voltage at which, by their models, they are where a straight actuator would be.

    The straight actuator's response is the chord of the model's over its range of voltage, so a controller before
    the block sees the same gain with it and without.  A channel without a model passes unchanged, bit for bit.  Lag
    and delay of a model are left to the controller, which measures.  NaN passes as NaN, and moves nothing.

    Ports: `asked` (V) in, `voltage` (V) out.

    Parameters
    ----------
    models : sequence of HysteresisModel or None
        One a channel; None: unchanged.

    Raises
    ------
    ValueError : no channel at all.
    """

    def __init__(self, models: Sequence[HysteresisModel | None]) -> None:
        if not models:
            raise ValueError("models is empty, must have one model, or None, a channel")
        self.inputs = (Port("asked", "V", len(models)),)
        self.outputs = (Port("voltage", "V", len(models)),)
        self.models = tuple(models)
        self._tables = _tables(self.models)

    def prepare(self, rate: float, frames: int) -> None:
        """Take every stack as depolarized, at the lowest voltage of its model's range."""
        self._tables = _tables(self.models)

    def process(self, asked: np.ndarray, voltage: np.ndarray) -> None:
        """Compensate one frame."""
        kernel.compensate(asked, voltage, *self._tables)

    def change(self, models: Sequence[HysteresisModel | None]) -> None:
        """Take other models (between ticks), their plays as after `prepare`.

        Raises
        ------
        ValueError : not one a channel.
        """
        if len(models) != len(self.models):
            raise ValueError(f"{len(models)} models, must be {len(self.models)}: one, or None, a channel")
        self.models = tuple(models)
        self._tables = _tables(self.models)


def _tables(models: Sequence[HysteresisModel | None]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the kernel's: on, shapes, plays and memory, channel by channel; plays of no weight fill up."""
    most = max([1, *(len(model.thresholds) for model in models if model is not None)])
    on = np.array([model is not None for model in models])
    shapes = np.zeros((len(models), kernel.SHAPE + 2))
    plays, memory = np.zeros((len(models), most, 2)), np.zeros((len(models), most + 1))
    for channel, model in enumerate(models):
        if model is not None:
            shapes[channel] = [*model.shape, *model.span]
            plays[channel, : len(model.thresholds)] = model.plays
            kernel.reset(model.low, shapes[channel], memory[channel])
    return on, shapes, plays, memory
