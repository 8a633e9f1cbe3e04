"""The API over HTTP and WebSocket: it checks what a request looks like and hands it to the rig's process."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeVar

from fastapi import APIRouter, FastAPI, Header, Query, Request, Response, Security
from fastapi.responses import FileResponse, JSONResponse
from fastapi.security import HTTPBearer
from fastapi.staticfiles import StaticFiles
from starlette.exceptions import HTTPException
from starlette.types import Receive, Scope, Send

from rigkit.service import answers, beginning, requests, runs, stop_request
from rigkit.service.journal import KEPT
from rigkit.service.json_answer import Json, answer_errors, answered, asked
from rigkit.service.link import Asking
from rigkit.service.metrics import Metrics
from rigkit.service.panel_cache import PanelCache
from rigkit.service.slot import Slot
from rigkit.service.snapshot import as_bytes
from rigkit.service.stream import Audience

Found = TypeVar("Found")
Key = Annotated[str, Header(alias="X-Control", max_length=60, description="key of the lease of control")]

_ERRORS: dict[int | str, dict[str, Any]] = {
    status: {"model": answers.Error, "description": text}
    for status, text in (
        (400, "not JSON, or none that can be read in one way only"),
        (401, "no token, or none of this daemon's"),
        (403, "the token (one to view may look and STOP), the host, the origin or who has control does not allow it"),
        (404, "there is no such thing"),
        (405, "not with this method"),
        (409, "the state of the rig does not allow it"),
        (413, "too long"),
        (422, "a value is not as it must be; or a procedure is refused while it is made, and the rig stays armed"),
        (429, "too many requests"),
        (500, "a slip of this program's, which the text names"),
        (503, "the rig's process could not do it, or does not answer"),
    )
}
_GETTING_READY = {"model": answers.Made, "description": "it is still being made; the state will say what comes of it"}
_TOKEN = Security(HTTPBearer(auto_error=False, description="a token of the daemon's token file"))
"""Of the description alone: the gate has looked at the token before anything comes here."""


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

    app = FastAPI(title=f"{name} daemon", version="1", lifespan=lifespan, docs_url=None, redoc_url=None)
    answer_errors(app)
    api = APIRouter(responses=_ERRORS, dependencies=[_TOKEN])
    _add_views(api, ends)
    _add_metrics(api, metrics)
    _add_files(api, ends)
    _add_commands(api, ends)
    _add_rare_commands(api, ends)
    _add_commands_with_a_reason(api, ends)
    app.include_router(api)
    app.state.routes = api.routes
    app.add_api_websocket_route("/api/stream", audience.attend)
    app.router.default = _page(StaticFiles(directory=ends.page, html=True))
    return app


def _page(files: StaticFiles) -> Callable[[Scope, Receive, Send], Awaitable[None]]:
    """Return what answers where nothing else does: files of the page, which speaks no WebSocket."""

    async def page(scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008, "reason": "there is no such stream"})
            return
        await files(scope, receive, send)

    return page


def _add_views(app: APIRouter, ends: Ends) -> None:
    def of_the_rig(name: str) -> tuple[int, bytes]:
        status, told = answered(ends.asking, "panel", name=name)
        return status, as_bytes(told)

    panels = PanelCache(ends.slot, of_the_rig)

    @app.get("/api/snapshot", response_model=answers.Snapshot)
    async def snapshot() -> Response:
        """Return what the stream sends, once."""
        content = ends.slot.get()
        if content is None:
            raise HTTPException(503, "the rig's process shows nothing")
        return Response(content, media_type="application/json")

    @app.get("/api/rig", response_model=answers.Rig)
    async def rig(request: Request) -> JSONResponse:
        """Return which rig this is, the procedures it can be told to do, and what the token may: view or operate."""
        return await _asked(ends.asking, "rig", role=request.state.role)

    @app.get("/api/settings", response_model=str)
    async def settings() -> JSONResponse:
        """Return the settings in force, as TOML in a text."""
        return await _asked(ends.asking, "settings")

    @app.get("/api/events", response_model=list[answers.Event])
    async def events(
        after: Annotated[requests.Tick, Query()] = 0, most: Annotated[int, Query(ge=1, le=KEPT)] = 200
    ) -> JSONResponse:
        """Return the newest events after event number `after`, in order."""
        return await _asked(ends.asking, "events", number=after, most=most)

    @app.get("/api/panels/{name}", response_model=answers.Panel)
    async def panel(name: str) -> Response:
        """Return a panel: curves, an image or a table; the snapshot says which there are, and their revisions."""
        status, content = await panels.get(name)
        return Response(content, status, media_type="application/json")


def _add_metrics(app: APIRouter, metrics: Metrics) -> None:
    @app.get("/metrics", response_class=Response, responses=_of_type("text/plain", "the gauges"))
    async def measured() -> Response:
        """Return the gauges in Prometheus' text format."""
        return Response(await asyncio.to_thread(metrics.text), media_type=metrics.media_type)


def _of_type(media: str, what: str, form: str | None = None) -> dict[int | str, dict[str, Any]]:
    """Describe an answer that is no JSON."""
    schema = {"type": "string"} | ({"format": form} if form else {})
    return {200: {"description": what, "content": {media: {"schema": schema}}}}


def _add_files(app: APIRouter, ends: Ends) -> None:
    @app.get("/api/runs", response_model=list[answers.Run])
    async def listed() -> JSONResponse:
        """Return the folders of runs, the newest first."""
        return Json(await asyncio.to_thread(runs.listed, ends.runs))

    @app.get("/api/runs/{run}", response_model=list[answers.File])
    async def files(run: str) -> JSONResponse:
        """Return the files of a run, by path."""
        return Json(await asyncio.to_thread(_found, runs.files, ends.runs, run))

    @app.get(
        "/api/runs/{run}/{path:path}", response_class=FileResponse, responses=_of_type("*/*", "the file", "binary")
    )
    async def file(run: str, path: str) -> FileResponse:
        """Return a file of a run."""
        found = await asyncio.to_thread(_found, runs.file, ends.runs, run, path)
        return FileResponse(found, filename=found.name)


def _add_commands(app: APIRouter, ends: Ends) -> None:
    @app.post("/api/control", response_model=answers.Lease)
    async def take_control(asked: requests.Control) -> JSONResponse:
        """Take control; its `key` goes with every command, and proves who commands."""
        return await _asked(ends.asking, "take_control", who=asked.who, over=asked.over)

    @app.put("/api/control", response_model=answers.Owner)
    async def renew(key: Key = "") -> JSONResponse:
        """Keep control for another while."""
        return await _asked(ends.asking, "renew", key=key)

    @app.delete("/api/control", response_model=answers.GivenBack)
    async def give_back(key: Key = "") -> JSONResponse:
        """Give control back."""
        return await _asked(ends.asking, "give_back", key=key)

    @app.post("/api/stop", response_model=answers.Made, openapi_extra=stop_request.DESCRIPTION)
    async def stop(request: Request) -> JSONResponse:
        """Bring the output to zero and disarm, now.  Any token may, the one to view as well; no body is refused."""
        who, why = stop_request.who_and_why(await request.body())
        asker = f"{request.state.role} at {request.client.host if request.client else 'socket'}"
        return await _asked(ends.urgent, "stop", who=who, why=why, asker=asker)

    @app.post("/api/begin", response_model=answers.Made, responses={202: _GETTING_READY})
    async def begin(asked: requests.Begin, key: Key = "") -> JSONResponse:
        """Begin a procedure: answered once it has begun, or has been refused; 202 where that takes very long."""
        wanted = {"name": asked.procedure, "options": asked.options, "why": asked.why}
        status, told = await beginning.begin(ends.asking, key=key, **wanted)
        return Json(told, status)


def _add_rare_commands(app: APIRouter, ends: Ends) -> None:
    @app.post("/api/fault", response_model=answers.Injected)
    async def fault(asked: requests.Fault, key: Key = "") -> JSONResponse:
        """Put a fault into a sensor on purpose, where daemon.faults allows it."""
        return await _asked(ends.asking, "inject", key=key, sensor=asked.sensor, kind=asked.kind)

    @app.post("/api/reload", response_model=answers.Reloaded)
    async def reload(key: Key = "") -> JSONResponse:
        """Read the rig file again, and do the least for what has changed."""
        return await _asked(ends.asking, "reload", key=key)


def _add_commands_with_a_reason(app: APIRouter, ends: Ends) -> None:
    for name, meaning in (
        ("arm", "Make the rig ready for procedures."),
        ("disarm", "Disarm the rig."),
        ("hold", "Pause the procedure after the present step."),
        ("resume", "Resume the procedure."),
        ("abort", "End the procedure after the present step; the rig stays armed."),
        ("acknowledge", "Leave FAULT, after the cause has been found."),
    ):
        add = app.post(f"/api/{name}", name=name, description=meaning, response_model=answers.Made)
        add(_with_reason(ends.asking, name))


def _with_reason(asking: Asking, name: str) -> Any:
    async def command(asked: requests.Why | None = None, key: Key = "") -> JSONResponse:
        return await _asked(asking, name, key=key, why=asked.why if asked else "")

    return command


async def _asked(asking: Asking, do: str, /, **arguments: Any) -> JSONResponse:
    status, told = await asked(asking, do, **arguments)
    return Json(told, status)


def _found(look: Callable[..., Found], root: Path, *names: str) -> Found:
    """Look for something among the runs; what is not there, or not to be had, is an answer as well."""
    try:
        return look(root, *names)
    except PermissionError as fault:
        raise HTTPException(403, str(fault)) from None
    except LookupError as fault:
        raise HTTPException(404, str(fault.args[0])) from None
