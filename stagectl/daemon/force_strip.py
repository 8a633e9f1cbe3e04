"""The force on the tool, drawn while it runs."""

import numpy as np

from rigkit.experiment.strips import strip
from rigkit.experiment.watch import WINDOW, Watch
from rigkit.service.show import Axis, Curves

AXES = ("x", "y", "z")


def force_strip(watch: Watch) -> Curves | None:
    """Draw the force that the sensor shows on the tool, N, where it counts; None where nothing has been seen."""
    time, force = watch.lately("force")
    valid = watch.lately("valid")[1]
    count = min(len(time), len(valid))
    if not count:
        return None
    rows = np.where(valid[-count:] > 0.5, force[-count:], np.nan)
    return strip(f"Force on the tool, last {WINDOW:g} s", Axis("force", "N"), time[-count:], rows, AXES)
