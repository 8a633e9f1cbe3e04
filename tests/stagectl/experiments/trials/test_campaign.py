"""Methods one after another from the same first trial: one that is refused does not take the others with it."""

from collections.abc import Generator
from types import SimpleNamespace
from typing import Any

import pytest

from stagectl.experiments.trials import campaign

WHY = "milled-0: the force's sign looks reversed"


def _air(first: str, _: object) -> Generator[tuple[str, str], str, str]:
    yield "free-0", first
    return first


def _pocket(first: str, _: object, method: int, iterations: int) -> Generator[tuple[str, str], str]:
    if method == 2:
        raise ValueError(WHY)
    for iteration in range(1, iterations + 1):
        yield f"method-{method}-{iteration}", first


def learned(monkeypatch: pytest.MonkeyPatch, *methods: int) -> tuple[list[str], list[tuple[int, str]]]:
    monkeypatch.setattr(campaign, "learn_free_space", _air)
    monkeypatch.setattr(campaign, "learn_pocket", _pocket)
    left: list[tuple[int, str]] = []
    learner: Any = SimpleNamespace(leave_out=lambda method, why: left.append((method, why)))
    first: Any = "trial"
    names: list[str] = []

    def run(name: str, trial: Any) -> Any:
        names.append(name)
        return trial

    campaign.carried_out(campaign.learn(first, learner, methods, 2), run)
    return names, left


def test_one_of_several_methods_that_is_refused_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    names, left = learned(monkeypatch, 1, 2, 3)
    assert names == ["free-0", "milled-0", "method-1-1", "method-1-2", "method-3-1", "method-3-2"]
    assert left == [(2, WHY)]


def test_the_only_method_is_refused_as_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError, match=WHY):
        learned(monkeypatch, 2)


def test_learning_ends_where_the_witness_foresees_nothing_to_be_won() -> None:
    first: Any = SimpleNamespace(name="milled-0", trial=None)
    step: Any = SimpleNamespace(witnessed=0.0, part=lambda _: step)
    told: list[str] = []
    learner: Any = SimpleNamespace(refuse_other_compliance=lambda *_: None, next_path=lambda *_: step, note=told.append)
    assert list(campaign.learn_pocket(first, learner, 2, 3)) == []
    assert "learning ends: the tracker foresees nothing to be won" in told[0]
