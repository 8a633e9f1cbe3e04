"""A small rig file's model, with a key of every type, for the tests of rigkit."""

from typing import Any, Literal, Self

from pydantic import model_validator

from rigkit.config import Section, setting


class Filter(Section):
    """A filter in a table of its own."""

    corner: float = setting(100.0, "Hz", "corner frequency", gt=0, le=1e4)


class Device(Section):
    """The device that plays.

    This second paragraph is for programmers.
    """

    rate: int = setting(44_100, "samples/s", "sample rate", ge=8_000, le=192_000)
    gain: float = setting(1.5, "V", "voltage at full scale", gt=0, lt=10)
    name: str = setting("card", "", "name of the device", min_length=1, max_length=20)
    stream: str = setting("sounddevice:Stream", "", "module:Class of the stream", pattern=r"^[\w.]+:\w+$")
    channels: tuple[int, ...] = setting((1, 2), "", "channels, counted from 1", min_length=1)
    band: tuple[float, float] = setting((15.0, 650.0), "Hz", "band")
    mode: Literal["fast", "slow"] = setting("fast", "", "how it plays")
    step: Literal[1, 4] = setting(4, "1", "decimation")
    isolated: bool = setting(True, "", "in a process of its own")
    filter: Filter = Filter()
    options: dict[str, Any] = setting({}, "", "keywords of the plant")

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if self.band[0] >= self.band[1]:
            raise ValueError(f"device.band is {self.band[0]:g} to {self.band[1]:g} Hz, must rise")
        return self


class RigFile(Section):
    """A whole rig file."""

    device: Device = Device()
