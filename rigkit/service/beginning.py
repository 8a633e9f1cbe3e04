"""A procedure that is begun over the network: the answer waits until it has begun, or until it has been refused."""

import asyncio
import time
from typing import Any

from rigkit.service import answers
from rigkit.service.json_answer import asked
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
    status, told = await asked(asking, "begin", **command)
    if status != 200:
        return status, told
    number, until = told.pop("number"), time.monotonic() + WITHIN
    while time.monotonic() < until:
        status, came = await asked(asking, "begun", number=number)
        if status != 200:
            return status, came
        match came["outcome"]:
            case "begun":
                return 200, told
            case "not begun":
                return 422, {**answers.error(422, came["why"]), "reason": NOT_BEGUN}
            case "failed":
                return 503, answers.error(503, came["why"])
        await asyncio.sleep(LOOK)
    return 202, told
