"""The `process` of a Block that a simulated plant is all of: the arguments of its `run` are the Block's ports."""

from collections.abc import Callable
from inspect import signature
from typing import Any

import numpy as np


def run_of(plant: type[Any]) -> Callable[..., None]:
    """Return the `process` of a Block that has such a plant as its `plant`."""

    def process(self: Any, *signals: np.ndarray) -> None:
        self.plant.run(*signals)

    process.__signature__ = signature(plant.run)  # type: ignore[attr-defined]
    return process
