"""Answers of the API as JSON, those to what has gone wrong included."""

import asyncio
from functools import partial
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from starlette.exceptions import HTTPException
from starlette.routing import Match

from rigkit.service import answers
from rigkit.service.gate import Refusal
from rigkit.service.link import Asking, NoAnswer
from rigkit.service.snapshot import as_bytes


class Json(JSONResponse):
    """An answer, of whatever `as_bytes` writes."""

    def render(self, content: Any) -> bytes:
        """Return it as JSON."""
        return as_bytes(content)


def answered(asking: Asking, do: str, /, **arguments: Any) -> tuple[int, Any]:
    """Ask, which may wait; return the HTTP status, and what was told or the error."""
    answer = asking.ask({"do": do, "with": arguments})
    status = answer["status"]
    return status, answer["told"] if status == 200 else answers.error(status, answer["error"])


async def asked(asking: Asking, do: str, /, **arguments: Any) -> tuple[int, Any]:
    """Ask in a thread of the end's own: questions that wait for an answer hold up no STOP."""
    loop = asyncio.get_running_loop()
    return await loop.run_in_executor(asking.threads, partial(answered, asking, do, **arguments))


def answer_errors(app: FastAPI) -> None:
    """Let an application answer whatever goes wrong in it with one line of JSON."""
    for kind in (HTTPException, RequestValidationError, NoAnswer):
        app.add_exception_handler(kind, _as_error)
    app.add_exception_handler(Exception, _as_slip)


async def _as_error(request: Request, fault: Exception) -> JSONResponse:
    """Answer with one line, whatever it is that has no better answer."""
    if isinstance(fault, RequestValidationError):
        wrong = fault.errors()[0]
        where = ".".join(map(str, wrong["loc"]))
        return Json(answers.error(422, f"{where}: {wrong['msg']}"), 422)
    if isinstance(fault, HTTPException):
        if fault.status_code == 403:
            request.state.refused(Refusal(403, str(fault.detail)))
        headers = dict(fault.headers or {})
        if fault.status_code == 405 and (there := _methods(request)):
            headers["Allow"] = ", ".join(there)
        return Json(answers.error(fault.status_code, str(fault.detail)), fault.status_code, headers)
    return Json(answers.error(503, str(fault)), 503)


async def _as_slip(_: Request, fault: Exception) -> JSONResponse:
    """Answer for a slip of this program's; its traceback goes to the log of the process."""
    return Json(answers.error(500, f"{type(fault).__name__}: {fault}"), 500)


def _methods(request: Request) -> list[str]:
    """Return the methods of all ways in at a path: Starlette tells those of the first."""
    there = (route for route in request.app.state.routes if route.matches(request.scope)[0] is not Match.NONE)
    return sorted({method for route in there for method in getattr(route, "methods", None) or ()})
