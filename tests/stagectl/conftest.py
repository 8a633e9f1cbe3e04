"""Of loops that are designed for the same model with the same settings, one design is enough."""

import pickle
from collections.abc import Iterator

import pytest

from calibration.state_space.model import InnovationModel
from stagectl.config import Outer
from stagectl.stage.design import Design, design
from stagectl.stage.weights import Weights

_made: dict[bytes, bytes] = {}


def _design(model: InnovationModel, outer: Outer, axis: int, weights: Weights | None = None) -> Design:
    key = pickle.dumps((model, outer, axis, weights))
    if key not in _made:
        _made[key] = pickle.dumps(design(model, outer, axis, weights))
    made: Design = pickle.loads(_made[key])
    return made


@pytest.fixture(scope="session", autouse=True)
def _each_loop_is_designed_once() -> Iterator[None]:
    """Save a second of each run; what a design is has tests of its own, which call it."""
    with pytest.MonkeyPatch.context() as patch:
        for place in ("stagectl.experiments.piezo.setup", "stagectl.experiments.toroid.plan"):
            patch.setattr(f"{place}.design", _design)
        yield
