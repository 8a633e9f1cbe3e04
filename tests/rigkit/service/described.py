"""Whether what a rig's daemon answers is what the API's description says."""

import json
from typing import Any

from pydantic import TypeAdapter

from rigkit.service import answers
from rigkit.service.commands import Commands
from rigkit.service.control import Control
from rigkit.service.snapshot import as_bytes, snapshot


def is_described(model: Any, told: Any) -> None:
    """Fail where an answer, as it goes through the wire, is not of the model that describes it."""
    TypeAdapter(model).validate_json(as_bytes(told))


def views_are_described(control: Control) -> dict[str, Any]:
    """Look at all that can be seen of a rig now, and return its snapshot."""
    commands = Commands(control)

    def told(do: str, **arguments: Any) -> Any:
        answer = commands.answer({"do": do, "with": arguments})
        assert answer["status"] == 200, answer
        return answer["told"]

    shown: dict[str, Any] = json.loads(as_bytes(snapshot(control, 1, 0, 0.0)))
    is_described(answers.Snapshot, shown)
    is_described(answers.Rig, told("rig", role="operate"))
    is_described(list[answers.Event], told("events", number=0))
    is_described(str, told("settings"))
    for name in shown["panels"]:
        is_described(answers.Panel, told("panel", name=name))
    return shown
