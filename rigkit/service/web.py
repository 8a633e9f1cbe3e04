"""The API over HTTP and WebSocket: it checks what a request looks like and hands it to the rig's process."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from fastapi import FastAPI, Header, Query, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.responses import FileResponse, JSONResponse, PlainTextResponse
from fastapi.staticfiles import StaticFiles
from starlette.exceptions import HTTPException

from rigkit.service import requests
from rigkit.service.journal import KEPT
from rigkit.service.link import Asking, NoAnswer
from rigkit.service.metrics import Metrics
from rigkit.service.panel_cache import PanelCache
from rigkit.service.paths import confined
from rigkit.service.slot import Slot
from rigkit.service.snapshot import as_bytes
from rigkit.service.stream import Audience

Key = Annotated[str, Header(alias="X-Control", max_length=60, description="key of the lease of control")]

_ERRORS: dict[int | str, dict[str, Any]] = {
    status: {"model": requests.Error, "description": text}
    for status, text in (
        (400, "not JSON"),
        (401, "no token, or none of this daemon's"),
        (403, "the token, the host, the origin or who has control does not allow it"),
        (404, "there is no such thing"),
        (409, "the state of the rig does not allow it"),
        (413, "too long"),
        (422, "a value is not as it must be"),
        (429, "too many requests"),
        (503, "the rig's process could not do it, or does not answer"),
    )
}


@dataclass(frozen=True)
class Ends:
    """What the web process has of the rig's.

    Parameters
    ----------
    slot : Slot
        Snapshots.
    asking : Asking
        For questions and commands.
    urgent : Asking
        For STOP, which waits behind nothing.
    runs : Path
        Folder of what may be downloaded.
    page : Path
        Folder of the page.
    """

    slot: Slot
    asking: Asking
    urgent: Asking
    runs: Path
    page: Path


def application(ends: Ends, audience: Audience, metrics: Metrics, name: str) -> FastAPI:
    """Make the application, without the gate in front of it."""

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        following = asyncio.create_task(audience.follow())
        yield
        following.cancel()
        with suppress(asyncio.CancelledError):
            await following

    app = FastAPI(
        title=f"{name} daemon", version="1", lifespan=lifespan, docs_url=None, redoc_url=None, responses=_ERRORS
    )
    app.add_exception_handler(HTTPException, _as_error)
    app.add_exception_handler(RequestValidationError, _as_error)
    app.add_exception_handler(NoAnswer, _as_error)
    _add_views(app, ends, metrics)
    _add_files(app, ends)
    _add_commands(app, ends)
    _add_commands_with_a_reason(app, ends)
    app.add_api_websocket_route("/api/stream", audience.attend)
    if ends.page.is_dir():
        app.mount("/", StaticFiles(directory=ends.page, html=True))
    return app


def _add_views(app: FastAPI, ends: Ends, metrics: Metrics) -> None:
    def of_the_rig(name: str) -> tuple[int, bytes]:
        status, told = _answered(ends.asking, "panel", name=name)
        return status, as_bytes(told)

    panels = PanelCache(ends.slot, of_the_rig)

    @app.get("/api/snapshot")
    async def snapshot() -> Response:
        """Return what the stream sends, once."""
        return Response(ends.slot.get() or b"null", media_type="application/json")

    @app.get("/api/rig")
    async def rig(request: Request) -> JSONResponse:
        """Return which rig this is, the procedures it can be told to do, and what the token may: view or operate."""
        return await _asked(ends.asking, "rig", role=request.state.role)

    @app.get("/api/settings")
    async def settings() -> JSONResponse:
        """Return the settings in force, as TOML in a text."""
        return await _asked(ends.asking, "settings")

    @app.get("/api/events")
    async def events(
        after: Annotated[requests.Tick, Query()] = 0, most: Annotated[int, Query(ge=1, le=KEPT)] = 200
    ) -> JSONResponse:
        """Return the newest events after event number `after`, in order."""
        return await _asked(ends.asking, "events", number=after, most=most)

    @app.get("/api/panels/{name}")
    async def panel(name: str) -> Response:
        """Return a panel: curves, an image or a table; the snapshot says which there are, and their revisions."""
        status, content = await panels.get(name)
        return Response(content, status, media_type="application/json")

    @app.get("/metrics", response_class=PlainTextResponse)
    async def measured() -> Response:
        """Return the gauges in Prometheus' text format."""
        return Response(await asyncio.to_thread(metrics.text), media_type=metrics.media_type)


def _add_files(app: FastAPI, ends: Ends) -> None:
    @app.get("/api/runs")
    async def runs() -> JSONResponse:
        """Return the names of the folders of runs, the newest first."""
        return JSONResponse(await asyncio.to_thread(_folders, ends.runs))

    @app.get("/api/runs/{path:path}", response_class=FileResponse)
    async def file(path: str) -> FileResponse:
        """Return a file of a run."""
        return FileResponse(await asyncio.to_thread(_file, ends.runs, path))


def _add_commands(app: FastAPI, ends: Ends) -> None:
    @app.post("/api/control")
    async def take_control(asked: requests.Control) -> JSONResponse:
        """Take control; its `key` goes with every command, and proves who commands."""
        return await _asked(ends.asking, "take_control", who=asked.who, over=asked.over)

    @app.put("/api/control")
    async def renew(key: Key = "") -> JSONResponse:
        """Keep control for another while."""
        return await _asked(ends.asking, "renew", key=key)

    @app.delete("/api/control")
    async def give_back(key: Key = "") -> JSONResponse:
        """Give control back."""
        return await _asked(ends.asking, "give_back", key=key)

    @app.post("/api/stop")
    async def stop(asked: requests.Stop | None = None) -> JSONResponse:
        """Bring the output to zero and disarm, now.  It needs no control, and no body."""
        asked = asked or requests.Stop()
        return await _asked(ends.urgent, "stop", who=asked.who, why=asked.why)

    @app.post("/api/begin")
    async def begin(asked: requests.Begin, key: Key = "") -> JSONResponse:
        """Begin a procedure."""
        told = {"name": asked.procedure, "options": asked.options, "why": asked.why}
        return await _asked(ends.asking, "begin", key=key, **told)

    @app.post("/api/fault")
    async def fault(asked: requests.Fault, key: Key = "") -> JSONResponse:
        """Put a fault into a sensor on purpose, where daemon.faults allows it."""
        return await _asked(ends.asking, "inject", key=key, sensor=asked.sensor, kind=asked.kind)

    @app.post("/api/reload")
    async def reload(key: Key = "") -> JSONResponse:
        """Read the rig file again, and do the least for what has changed."""
        return await _asked(ends.asking, "reload", key=key)


def _add_commands_with_a_reason(app: FastAPI, ends: Ends) -> None:
    for name, meaning in (
        ("arm", "Make the rig ready for procedures."),
        ("disarm", "Take that back."),
        ("hold", "Let the procedure pause after the step under way."),
        ("resume", "Let it go on."),
        ("abort", "Let it end after the step under way; the rig stays armed."),
        ("acknowledge", "Leave FAULT, after finding out why."),
    ):
        app.post(f"/api/{name}", name=name, description=meaning)(_with_reason(ends.asking, name))


def _with_reason(asking: Asking, name: str) -> Any:
    async def command(asked: requests.Why | None = None, key: Key = "") -> JSONResponse:
        return await _asked(asking, name, key=key, why=asked.why if asked else "")

    return command


async def _asked(asking: Asking, do: str, /, **arguments: Any) -> JSONResponse:
    status, told = await asyncio.to_thread(partial(_answered, asking, do, **arguments))
    return _Json(told, status)


def _answered(asking: Asking, do: str, /, **arguments: Any) -> tuple[int, Any]:
    answer = asking.ask({"do": do, "with": arguments})
    status = answer["status"]
    return status, answer["told"] if status == 200 else {"error": answer["error"]}


class _Json(JSONResponse):
    def render(self, content: Any) -> bytes:
        return as_bytes(content)


async def _as_error(_: Request, fault: Exception) -> JSONResponse:
    """Answer with one line, whatever it is that has no better answer."""
    if isinstance(fault, RequestValidationError):
        wrong = fault.errors()[0]
        where = ".".join(map(str, wrong["loc"]))
        return _Json({"error": f"{where}: {wrong['msg']}"}, 422)
    if isinstance(fault, HTTPException):
        return _Json({"error": str(fault.detail)}, fault.status_code)
    return _Json({"error": str(fault)}, 503)


def _folders(runs: Path) -> list[str]:
    held = [path for path in runs.iterdir() if path.is_dir() and not path.name.startswith(".")] if runs.is_dir() else []
    return [path.name for path in sorted(held, key=lambda path: path.stat().st_mtime, reverse=True)]


def _file(runs: Path, text: str) -> Path:
    try:
        path = confined(runs, text)
    except PermissionError as fault:
        raise HTTPException(403, str(fault)) from None
    if not path.is_file():
        raise HTTPException(404, f"there is no file {text[:200]!r} among the runs")
    return path
