"""A procedure that is begun over the network: the answer waits until it has begun, or until it has been refused."""

import asyncio
import time
from functools import partial
from typing import Any

from rigkit.service import answers
from rigkit.service.link import Asking

WITHIN = 60.0
"""s for which an answer waits; a design of loops, or the models of a mill, may take as long."""
LOOK = 0.02
"""s between two looks."""
NOT_BEGUN: answers.Reason = "not_begun"


async def begin(asking: Asking, **command: Any) -> tuple[int, Any]:
    """Begin a procedure; return the HTTP status and what is answered.

    Parameters
    ----------
    asking : Asking
    **command
        Of `rigkit.service.control.Control.begin`.
    """
    answer = await _ask(asking, "begin", command)
    if answer["status"] != 200:
        return answer["status"], answers.error(answer["status"], answer["error"])
    told = dict(answer["told"])
    number, until = told.pop("number"), time.monotonic() + WITHIN
    while time.monotonic() < until:
        match (await _ask(asking, "begun", {"number": number}))["told"]:
            case {"outcome": "begun"}:
                return 200, told
            case {"outcome": "not begun", "why": why}:
                return 422, {**answers.error(422, why), "reason": NOT_BEGUN}
            case {"outcome": "failed", "why": why}:
                return 503, answers.error(503, why)
        await asyncio.sleep(LOOK)
    return 202, told


async def _ask(asking: Asking, do: str, arguments: dict[str, Any]) -> dict[str, Any]:
    loop = asyncio.get_running_loop()
    return await loop.run_in_executor(asking.threads, partial(asking.ask, {"do": do, "with": arguments}))
