"""The tables `[link]` and `[laser]` of the stage's rig file."""

from typing import Any, Literal, Self

from pydantic import Field, model_validator

from rigkit.config import Section, code, setting
from rigkit.relay.config import Relay
from stagectl.wire.bus_load import least_load
from stagectl.wire.messages import HOLD, SILENCE


class Link(Section):
    """The CAN bus to the stage's processor."""

    role = "patience"

    bus: str = code("stagectl.link.slcan:SlcanBus", "module:Class with can.Bus's constructor, such as can:Bus")
    channel: str = setting("/dev/ttyACM0", "", "the adapter's port, or the interface's name", min_length=1)
    form: Literal["fd", "classic"] = setting("fd", "", "CAN FD: ten samples a frame; classic CAN: one in ten")
    bitrate: int = setting(1_000_000, "bit/s", "of a classic bus, and of the arbitration", ge=125_000, le=1_000_000)
    data_bitrate: int = setting(5_000_000, "bit/s", "of a CAN FD frame's data", ge=1_000_000, le=8_000_000)
    options: dict[str, Any] = setting({}, "", "more keywords the bus is built with, such as interface")
    origin: float = setting(
        225e-6, "m", "position that is transmitted as zero: mid-travel", ge=-1e-2, le=1e-2, role="wiring"
    )
    silence: float = setting(SILENCE, "s", "time without a heartbeat of the host that is a fault", ge=0.01, le=10)
    hold: float = setting(
        HOLD, "s", "beyond silence, for which references or the stage's frames may be missing", ge=0, le=10
    )
    patience: float = setting(2.0, "s", "time-out for the stage's first frame and for its answers", ge=0.05, le=60)
    relay: Relay = Field(default_factory=Relay)

    @property
    def stall(self) -> float:
        """Time without references, or a heartbeat of the stage, that is a fault, s."""
        return self.silence + self.hold

    @model_validator(mode="after")
    def _fits_on_the_bus(self) -> Self:
        load = least_load(self.form, self.bitrate, self.data_bitrate)
        if not load <= 1:
            raise ValueError(
                f"link.bitrate {self.bitrate} bit/s{f' with {self.data_bitrate}' if self.form == 'fd' else ''} is too "
                f"slow for link.form {self.form}: the bus would be busy for {100 * load:.0f} % of the time"
            )
        return self


class Laser(Section):
    """The lasers that the stage's processor reads, one an axis."""

    role = "plant"

    on: bool = setting(False, "", "the stage's processor reads a laser an axis; a live run records it")
    rate: float = setting(5_000.0, "Hz", "readings a second of the stage's lasers", ge=100, le=10_000)
    late: float = setting(1e-3, "s", "age of a reading beyond three cycles of its laser that is allowed", ge=0, le=0.1)
    stuck: int = setting(200, "readings", "identical readings in a row that mean a stuck laser", ge=10, le=100_000)
    speed: float = setting(0.25, "m/s", "largest plausible speed of a laser's reading", gt=0, le=10)


GONE = tuple(f"laser.{key}" for key in ("port", "device", "baud", "mode", "output", "scale", "silence"))
"""Keys that runs of before have in their files: of a laser on a serial line of the host, which no run has read."""
