"""Take the pictures of the daemon's page: `python -m benchmarks.daemon_pictures [vibrator|stage|cell]`.

All three, if none is named; each has a simulated rig at work.  They go into docs/images/service/, and want Chromium.
"""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.daemon_page import WALL, Page, page
from ctlblocks import recording
from ctlblocks.recording import Recording
from tests.rigkit.service.page.browser import PHONE

SHOT = 4
"""The shot of the vibrator after which its pictures are taken."""


def main() -> None:
    """Take those that are named, or all."""
    for name in sys.argv[1:] or VISITS:
        VISITS[name]()


def vibrator() -> None:
    """Calibrate, learn, look, kill: the wall, light and dark, the whole page, a phone, a page that has gone grey."""
    with page("vibractl", ["rig.name=basin"]) as seen:
        seen.arm("basin is clear")
        seen.begin("calibrate")
        seen.ended()
        seen.begin("run", run="40-90-hz", shots="30")
        seen.until_done(f"{SHOT} of")
        for name, size, dark in (("wall-dark", WALL, True), ("wall", WALL, False), ("phone", PHONE, False)):
            _in_mid_shot(seen, size, dark)
            seen.picture(name)
        seen.tab.run("document.getElementById('panels').scrollIntoView()")
        seen.picture("phone-panels")
        _in_mid_shot(seen, WALL)
        seen.picture("whole", whole=True)
        _in_mid_shot(seen, WALL)
        seen.kill()
        seen.picture("old")


def _in_mid_shot(seen: Page, size: tuple[int, int], dark: bool = False) -> None:
    seen.take(size, dark)
    seen.until_output("Output zero")
    seen.until_output("Output on")


def stage() -> None:
    """Calibrate, and follow a sine on each axis: errors, travel, voltages."""
    with page("stagectl", ["rig.name=stage 1", "session.lead=1"]) as seen:
        seen.arm("plate is clear")
        seen.begin("calibrate")
        seen.ended()
        _write_sines(seen.data / "sines.wav")
        seen.begin("follow", run="sines", reference="sines.wav", seconds="60")
        seen.until_panel("Spectrum")
        seen.take(WALL)
        seen.picture("stage")


def _write_sines(file: Path) -> None:
    """Write 60 s of a sine of 20 µm on each axis, about mid-travel, at 1, 2 and 3 Hz."""
    time = np.arange(60_000) / 1_000.0
    wanted = 225e-6 + 20e-6 * np.sin(2 * np.pi * np.outer(time, [1.0, 2.0, 3.0]))
    recording.write(file, Recording(("x", "y", "z"), ("m",) * 3, 1_000.0, wanted))


def cell() -> None:
    """Calibrate a joint, mill by force, learn: a torque-position map, kappa and beta, convergence."""
    with page("stagectl", ["rig.name=cell 2", "robot.arm=irb140"]) as seen:
        seen.arm("nobody is in the cell")
        calibrate_a_joint(seen)
        mill_by_force(seen)
        learn(seen)


def calibrate_a_joint(seen: Page) -> None:
    """See the map of joint 3 as it grows."""
    seen.begin("calibrate-joints", joints="3", paced="true")
    seen.until_panel("Joint 3: 3 cycles")
    seen.take(WALL)
    seen.picture("cell-joint")
    seen.ended()


def mill_by_force(seen: Page) -> None:
    """See force, feed, kappa and beta while a pocket is milled."""
    seen.begin("force", run="pocket-1", task="pocket", paced="true")
    seen.until_panel("Kappa")
    seen.until_some_is_done()
    seen.take(WALL)
    seen.picture("cell-force")
    seen.tab.press("abort")
    seen.ended()


def learn(seen: Page) -> None:
    """Calibrate milling, and see errors and forces after three trials in material."""
    seen.begin("calibrate-milling")
    seen.ended()
    seen.begin("ilc", run="pocket-28")
    seen.until_panel("method-1-2")
    seen.take(WALL)
    seen.picture("cell-learning")


VISITS: dict[str, Callable[[], None]] = {"vibrator": vibrator, "stage": stage, "cell": cell}

if __name__ == "__main__":
    main()
