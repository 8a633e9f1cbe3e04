"""What the API answers, as its published description has it; the answers themselves are made without these models."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from rigkit.service.access import Role
from rigkit.service.show import Output
from rigkit.service.show import Role as TraceRole
from rigkit.service.state import Event as StateEvent
from rigkit.service.state import State

Number = float | None
"""A number; null where it is not finite, or not known."""
Pair = tuple[Number, Number]
Time = Annotated[str, Field(json_schema_extra={"format": "date-time"}, description="UTC")]


class _Answer(BaseModel):
    """An answer without surprises."""

    model_config = ConfigDict(extra="forbid", strict=True)


Reason = Literal[
    "unreadable", "no_token", "not_allowed", "unknown", "method", "wrong_state", "too_long", "invalid", "not_begun",
    "too_many", "slip", "failed",
]  # fmt: skip
_REASONS: dict[int, Reason] = {
    400: "unreadable",
    401: "no_token",
    403: "not_allowed",
    404: "unknown",
    405: "method",
    409: "wrong_state",
    413: "too_long",
    422: "invalid",
    429: "too_many",
    500: "slip",
    503: "failed",
}


class Error(_Answer):
    """Why nothing was done, in one line, and for a program in one word."""

    error: str
    reason: Reason


def error(status: int, text: str) -> dict[str, str]:
    """Return an `Error` as JSON has it, its reason by the HTTP status."""
    return {"error": text, "reason": _REASONS.get(status, "failed")}


class Standing(_Answer):
    """The state that the rig is in."""

    name: State
    since: Time
    who: str = Field(description="who has brought it there")
    why: str
    ending: bool = Field(description="a procedure that was stopped has not ended yet")


class Owner(_Answer):
    """Who has control."""

    who: str
    seconds: float = Field(description="s until it is free, unless it is used")


class Progress(_Answer):
    """The procedure under way."""

    name: str
    title: str
    who: str
    done: float
    total: float
    unit: str
    note: str
    seconds_left: Number
    pausable: bool
    held: bool
    ending: bool
    on_pause: str
    on_abort: str


class Gauge(_Answer):
    """One number that is measured now, and what it may be."""

    name: str
    title: str
    value: Number
    unit: str
    low: Number
    high: Number
    interval: Pair | None = Field(description="where the true value lies, for an estimate")
    is_output: bool = Field(description="what the rig puts out, which is 0 while nothing moves")
    verdict: Literal["unknown", "free", "good", "near", "over"]


class Snapshot(_Answer):
    """How the rig stands."""

    tick: int
    time: Time
    program: str
    rig: str
    state: Standing
    allowed: list[StateEvent] = Field(description="what the state allows, whoever has control")
    control: Owner | None
    faults: dict[str, str] = Field(description="faults on purpose, by sensor")
    recording: bool
    procedure: Progress | None
    output: Output = Field(description="whether the rig puts something out; unknown where that is not measured")
    gauges: list[Gauge]
    panels: dict[str, int] = Field(description="revision of each panel that there is")
    events: int = Field(description="number of the last event")
    journal_fault: str = Field(description="why events are not on the disk; empty where they are")
    late_ticks: int


class Procedure(_Answer):
    """Something the rig can be told to do."""

    name: str
    title: str
    kind: Literal["calibrate", "run"]
    unit: str
    pausable: bool
    on_pause: str
    on_abort: str
    options: dict[str, Any] = Field(description="JSON schema of its options")


class Rig(_Answer):
    """Which rig this is, and what it can be told to do."""

    program: str
    rig: str
    role: Role = Field(description="what the token allows: view, to look and to STOP, or operate, to command as well")
    procedures: list[Procedure]
    fault_sensors: list[str] = Field(description="where faults may be put in on purpose; none where that is off")
    fault_kinds: list[str]


class Event(BaseModel):
    """Something that has happened; its particulars stand beside these."""

    model_config = ConfigDict(extra="allow", strict=True)

    number: int
    time: Time
    event: str
    who: str


class Axis(_Answer):
    """What lies along one direction of a panel."""

    title: str
    unit: str
    scale: Literal["linear", "log"]


class Trace(_Answer):
    """One line."""

    name: str
    x: list[Number]
    y: list[Number] = Field(description="null is a gap")
    role: TraceRole
    low: list[Number] | None = Field(description="lower end of the band in which the true values lie")
    high: list[Number] | None


class _Panel(_Answer):
    """What every panel has."""

    name: str
    revision: int = Field(description="moves on when the panel has changed")
    title: str


class Curves(_Panel):
    """Lines, bars or points over one abscissa."""

    kind: Literal["curves"]
    x: Axis
    y: Axis
    traces: list[Trace]
    drawn: Literal["lines", "bars", "points"]


class Image(_Panel):
    """Colours over a plane."""

    kind: Literal["image"]
    x: Axis
    y: Axis
    z: Axis
    x_range: Pair = Field(description="centres of the first and last column")
    y_range: Pair = Field(description="centres of the first and last row")
    z_range: Pair = Field(description="ends of the colour scale")
    values: list[list[Number]] = Field(description="row by row")


class Table(_Panel):
    """Rows under a head."""

    kind: Literal["table"]
    head: list[str]
    rows: list[list[str | float | None]]


Panel = Annotated[Curves | Image | Table, Field(discriminator="kind")]


class Run(_Answer):
    """A folder of what has been recorded."""

    name: str
    time: Time = Field(description="when something was put into it last, UTC")


class File(_Answer):
    """A file of a run."""

    path: str = Field(description="within the run: it goes behind /api/runs/RUN/")
    size: int = Field(description="bytes")
    time: Time = Field(description="when it was written last, UTC")


class Lease(_Answer):
    """Control was taken."""

    key: str = Field(description="goes with every command, as X-Control")
    who: str
    seconds: float = Field(description="s until it is free, unless it is used")


class GivenBack(_Answer):
    """Control was given back."""

    who: str


class Made(_Answer):
    """What a command has led to."""

    state: State
    before: State
    why: str


class Injected(_Answer):
    """Faults on purpose, by sensor."""

    faults: dict[str, str]


class Reloaded(_Answer):
    """What an edit of the rig file has led to."""

    reach: Literal["nothing", "parameters", "graph", "devices"]
    keys: list[str]
    done: str
