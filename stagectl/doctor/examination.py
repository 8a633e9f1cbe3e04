"""What the machine's lateness means for the time limits of a cell's file and of a stage's."""

import math
from collections.abc import Iterator
from pathlib import Path

from rigkit.verdict import Verdict, graded
from stagectl.config import StageConfig
from stagectl.doctor.wake_up import WakeUps
from stagectl.robot.config import CellConfig
from stagectl.wire.robot import RATE

USUAL = 0.5
"""Of a limit, up to which the worst that was seen leaves room for what a longer run may bring."""
CHANCE = 2.0
"""Times the worst that was seen, that a limit is advised to be."""
_PROGRAMS = (
    "end other programs, run on a machine of its own, or let this one have real-time priority; or set "
    "{key} = {value:g}, which the robot or stage must allow as well"
)


def examined(seen: WakeUps, cell: CellConfig, stage: StageConfig, is_granted: bool) -> list[Verdict]:
    """Judge what was seen by each limit on silence.

    Parameters
    ----------
    seen : WakeUps
    cell : CellConfig
    stage : StageConfig
    is_granted : bool
        Whether this program may have real-time priority.
    """
    robot = cell.robot.silence / RATE
    found = [
        _priority(is_granted),
        *_governors(),
        _limit("the robot's cycle", "robot.silence", robot, seen, math.ceil(CHANCE * seen.worst * RATE)),
        _limit("the force sensor", "force_sensor.silence", cell.force_sensor.silence, seen, _rounded(seen)),
        _limit("the stage's link", "link.silence", stage.link.silence, seen, _rounded(seen)),
    ]
    return found


def _rounded(seen: WakeUps) -> float:
    return float(f"{CHANCE * seen.worst:.1g}")


def _limit(check: str, key: str, limit: float, seen: WakeUps, advised: float) -> Verdict:
    grade = graded(seen.worst, USUAL * limit, limit)
    measured = f"worst {1e3 * seen.worst:.2f} ms, 99.9 % within {1e3 * seen.quantile(0.999):.2f} ms"
    if times := seen.beyond(limit):
        measured += f"; {times} of {len(seen.late)} beyond the limit"
    advice = "" if grade == "pass" else _PROGRAMS.format(key=key, value=advised)
    detail = {"limit": limit, "beyond": float(times), "within_999": seen.quantile(0.999)}
    return Verdict(check, grade, measured, f"<= {1e3 * USUAL * limit:g} ms, {key} allows {1e3 * limit:g} ms", advice,
                   seen.worst, "s", detail)  # fmt: skip


def _priority(is_granted: bool) -> Verdict:
    advice = "" if is_granted else (
        "grant it: `ulimit -r 90` in the shell, or a line `@lab - rtprio 90` in /etc/security/limits.conf for the "
        "group of who runs it; see packaging/ for the service"
    )  # fmt: skip
    said = "granted" if is_granted else "not granted"
    return Verdict("real-time priority", "pass" if is_granted else "warn", said, "granted", advice)


def _governors() -> Iterator[Verdict]:
    """Judge what sets the cores' clocks, where the system tells it."""
    found = {file.read_text().strip() for file in Path("/sys/devices/system/cpu").glob("cpu*/cpufreq/scaling_governor")}
    if found:
        is_slow = "powersave" in found
        advice = "`cpupower frequency-set -g performance`: cores that sleep wake late" if is_slow else ""
        said = ", ".join(sorted(found))
        yield Verdict("the cores' clock", "warn" if is_slow else "pass", said, "not powersave", advice)
