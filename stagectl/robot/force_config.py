"""The table of the robot cell's file for the force sensor at the wrist."""

from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field

from rigkit.config import Section, setting
from stagectl.wire.force_sensor import PORT
from stagectl.wire.makes import FORCE_SENSORS, known

Positive = Annotated[float, Field(gt=0, le=1e6)]
Three = tuple[Positive, Positive, Positive]
ForceMake = Annotated[str, AfterValidator(lambda name: known(name, FORCE_SENSORS))]


class ForceSensor(Section):
    """The force sensor's network box, UDP in the manner of ATI's Net F/T."""

    role = "patience"

    wire: ForceMake = setting("netft", "", "make of its protocol: netft", role="wiring")
    host: str = setting("127.0.0.1", "", "its address", min_length=1)
    port: int = setting(PORT, "", "its UDP port", ge=1, le=65_535)
    listen: str = setting("127.0.0.1", "", "this computer's address towards it", min_length=1)
    rate: float = setting(500.0, "samples/s", "it sends", gt=0, le=10_000)
    counts_force: float = setting(1e6, "1/N", "counts of its box, as set there", gt=0, le=1e9, role="wiring")
    counts_moment: float = setting(1e6, "1/(N m)", "counts of its box, as set there", gt=0, le=1e9, role="wiring")
    range_force: Three = setting((400.0, 400.0, 800.0), "N", "x, y and z, where it saturates", role="wiring")
    range_moment: Three = setting((40.0, 40.0, 40.0), "N m", "x, y and z, where it saturates", role="wiring")
    silence: float = setting(0.02, "s", "without a record is a fault", gt=0, le=10)
    saturated: float = setting(0.02, "s", "at an end of its range for longer is a fault", ge=0, le=10)
    rest: float = setting(0.5, "s", "at rest, of which the mean is zero force, and later shows its drift", gt=0, le=60)
    noise: float = setting(2.0, "N", "rms at rest; more is no rest", gt=0, le=1e3)
    drift: float = setting(5.0, "N", "off zero at rest is a fault", gt=0, le=1e3)
    drift_moment: float = setting(1.0, "N m", "off zero at rest is a fault", gt=0, le=1e3)

    @property
    def counts(self) -> np.ndarray:
        """Counts a N and a N m, shape (6,)."""
        return np.repeat([self.counts_force, self.counts_moment], 3)

    @property
    def range(self) -> np.ndarray:
        """Where it saturates, shape (6,), N and N m."""
        return np.array([*self.range_force, *self.range_moment])
