"""What made the work worse is not gone on from: back to the best path with part of the step, then an end."""

from dataclasses import dataclass

import numpy as np
import pytest

from stagectl.experiments.trials.lookback import PARTS, Lookback, Step


@dataclass(frozen=True, eq=False)
class Tried:
    """A trial of which only its name and its errors are known."""

    name: str
    norm: float
    noise: float = 0.0

    @property
    def slow_mae(self) -> np.ndarray:
        return np.array([self.norm, 0.0, 0.0])

    @property
    def slow_noise(self) -> np.ndarray:
        return np.array([0.0, self.noise, 0.0])


def looked(*norms: float) -> tuple[Lookback, list[str]]:
    first, *others = (Tried(f"trial-{number}", norm) for number, norm in enumerate(norms))
    back = Lookback(first)  # type: ignore[arg-type]
    return back, [back.take(each) for each in others]  # type: ignore[arg-type]


def test_trials_that_get_better_are_gone_on_from_with_whole_steps() -> None:
    back, said = looked(250e-6, 80e-6, 60e-6, 62e-6)
    assert said == ["", "", ""]
    assert [each.name for each in back.kept] == ["trial-0", "trial-1", "trial-2", "trial-3"]
    assert back.share == 1.0


def test_one_that_made_it_worse_is_left_and_half_the_step_is_made_from_the_best() -> None:
    back, said = looked(406e-6, 389e-6, 597e-6)
    assert said[-1] == "trial-2: 597 µm, where trial-1 had 389: back to that path, with 0.5 of the step"
    assert [each.name for each in back.kept] == ["trial-0", "trial-1"]
    assert back.share == 0.5
    assert not back.is_over


def test_what_never_helps_ends_with_the_path_it_began_with() -> None:
    back, said = looked(252e-6, 346e-6, 330e-6, 310e-6)
    assert back.is_over
    assert said[-1] == "trial-3: 310 µm, where trial-0 had 252: learning ends, the path of trial-0 is the best"
    assert len(said) == len(PARTS)


def test_a_worse_trial_within_noise_does_not_become_what_others_are_held_against() -> None:
    back, _ = looked(100e-6, 50e-6, 56e-6, 58e-6, 65e-6)
    assert [each.name for each in back.kept] == ["trial-0", "trial-1"]


@pytest.mark.parametrize(
    ("noise", "norm", "is_worse"),
    [(0.0, 104e-6, False), (0.0, 106e-6, True), (12e-6, 112e-6, False), (12e-6, 114e-6, True)],
)
def test_what_is_worse_than_nothing_by_more_than_blocks_and_noise_is_turned_back(
    noise: float, norm: float, is_worse: bool
) -> None:
    """Two blocks differ by 5 % of the error, and the tracker's noise is added as squares: 100 + 13 µm."""
    back = Lookback(Tried("trial-0", 100e-6))  # type: ignore[arg-type]
    said = back.take(Tried("trial-1", norm, noise))  # type: ignore[arg-type]
    assert bool(said) is is_worse


def test_part_of_a_step_is_foreseen_to_come_that_part_of_the_way() -> None:
    wanted = np.zeros((10, 3))
    step = Step(wanted, wanted - 2e-4, wanted + 1e-4, wanted, wanted, np.ones(10, bool))
    assert step.foreseen == 0.0
    assert step.part(0.5).foreseen == pytest.approx(np.sqrt(3) * 0.5e-4)
    assert step.part(0.5).sent == pytest.approx(wanted - 1e-4)
