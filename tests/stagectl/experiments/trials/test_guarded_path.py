"""A learned path that the port's guard would hold in the cut is refused before it is milled."""

import numpy as np
import pytest

from stagectl.experiments.trials.guarded_path import refuse_guarded
from stagectl.experiments.trials.tool_path import RATE
from tests.stagectl.experiments.trials.short_trial import small


def swung(size: float, frequency: float) -> np.ndarray:
    trial = small()
    time = np.arange(trial.path.samples) / RATE
    off = size * np.sin(2 * np.pi * frequency * time) * np.clip(time - 1.0, 0.0, 1.0)
    return np.asarray(trial.path.wanted + off[:, np.newaxis] * [1.0, 0.0, 0.0])


def test_a_path_within_the_limits_is_taken() -> None:
    refuse_guarded(small(), small().path.wanted)
    refuse_guarded(small(), swung(2e-4, 5.0))


@pytest.mark.parametrize(
    ("size", "frequency", "limit", "why"),
    [
        (1e-3, 10.0, "limits.tool_speed=0.05", r"at 1\.\d+ s the tool is asked to move at .* m/s, must be <= 0.05 m/s"),
        (1e-3, 10.0, "limits.speed=0.01", r"at 1\.\d+ s joint \d is asked to turn by .* deg/s, must be <= .* deg/s"),
    ],
)
def test_one_that_the_guard_would_hold_is_refused_with_time_and_limit(
    size: float, frequency: float, limit: str, why: str
) -> None:
    with pytest.raises(ValueError, match=why):
        refuse_guarded(small(limit), swung(size, frequency))
