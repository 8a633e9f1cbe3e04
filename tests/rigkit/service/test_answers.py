"""The API's description: every answer that a rig gives is of the model that says what it is."""

from typing import Any

import pytest
from pydantic import ValidationError

from rigkit.service import answers
from rigkit.service.commands import Commands
from rigkit.service.reload import Change, Reach
from rigkit.service.state import State
from tests.rigkit.service.conftest import Bench
from tests.rigkit.service.demo_rig import DemoRig
from tests.rigkit.service.described import is_described, views_are_described
from tests.until import until


def test_all_that_is_shown_is_described_whatever_the_state(bench: Bench) -> None:
    states = [views_are_described(bench.control)["state"]["name"]]
    bench.arm()
    states.append(views_are_described(bench.control)["state"]["name"])
    bench.begin(steps=100_000, seconds=0.01)
    until(lambda: len(bench.control.board.revisions()) == 5)
    states.append(views_are_described(bench.control)["state"]["name"])
    bench.control.hold(bench.key, "")
    states.append(views_are_described(bench.control)["state"]["name"])
    bench.control.fault("it smells")
    states.append(views_are_described(bench.control)["state"]["name"])
    bench.ended()
    assert states == ["DISARMED", "ARMED", "RUNNING", "HOLD", "FAULT"]


def test_what_each_command_answers_is_described(bench: Bench) -> None:
    commands, rig = Commands(bench.control), bench.rig
    rig.faults = DemoRig(faults=True).faults
    rig.change = Change({"audio.rate": Reach.DEVICES}, "now")

    def told(do: str, **arguments: Any) -> Any:
        answer = commands.answer({"do": do, "with": arguments})
        assert answer["status"] == 200, answer
        return answer["told"]

    lease = told("take_control", who="Bob", over=True)
    is_described(answers.Lease, lease)
    key = lease["key"]
    is_described(answers.Owner, told("renew", key=key))
    is_described(answers.Made, told("arm", key=key, why="a test"))
    made = told("begin", key=key, name="demonstrate", options={"steps": 1}, why="")
    until(lambda: told("begun", number=made["number"]) == {"outcome": "begun", "why": ""})
    is_described(answers.Made, {key: value for key, value in made.items() if key != "number"})
    is_described(answers.Injected, told("inject", key=key, sensor="travel", kind="nan"))
    is_described(answers.Reloaded, told("reload", key=key))
    is_described(answers.Made, told("stop", who="Ada", why="smoke"))
    bench.ended()
    is_described(answers.GivenBack, told("give_back", key=key))
    assert bench.state is State.DISARMED


@pytest.mark.parametrize(
    ("model", "told"),
    [
        (answers.Owner, {"who": "Ada", "seconds": 1.0, "more": 1}),
        (answers.Owner, {"who": "Ada"}),
        (answers.Owner, {"who": "Ada", "seconds": "1"}),
        (answers.Made, {"state": "ASLEEP", "before": "ARMED", "why": ""}),
        (answers.Panel, {"kind": "sound", "name": "a", "revision": 1, "title": "A"}),
    ],
)
def test_what_is_not_as_described_is_told_apart(model: Any, told: Any) -> None:
    with pytest.raises(ValidationError):
        is_described(model, told)
