"""What the API takes, as its published description has it."""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

Name = Annotated[str, Field(min_length=1, max_length=60, pattern=r"^[^\x00-\x1f\x7f]*\S[^\x00-\x1f\x7f]*$")]
Reason = Annotated[str, Field(max_length=200, pattern=r"^[^\x00-\x1f\x7f]*$")]
Tick = Annotated[int, Field(ge=0, le=2**53)]


class Strict(BaseModel):
    """A request without surprises: unknown keys and near values are refused."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class Control(Strict):
    """Ask for control."""

    who: Name = Field(description="the person who will command the rig")
    over: bool = Field(default=False, description="take it over from whoever has it")


class Why(Strict):
    """A command that needs nothing but a reason."""

    why: Reason = Field(default="", description="why; arm and acknowledge want a reason")


class Begin(Strict):
    """Begin a procedure."""

    procedure: str = Field(max_length=60, description="its name, from /api/rig")
    options: dict[str, Any] = Field(default={}, description="what it may be begun with, from /api/rig")
    why: Reason = Field(default="", description="why")


class Fault(Strict):
    """A fault on purpose."""

    sensor: str = Field(max_length=60, description="one of fault_sensors of /api/rig")
    kind: str = Field(max_length=20, description="one of fault_kinds of /api/rig; none takes it away")
