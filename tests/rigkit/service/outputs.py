"""What is shown of a rig's output while a procedure runs."""

from rigkit.service.control import Control
from rigkit.service.snapshot import snapshot
from tests.until import until


def until_on(control: Control) -> list[str]:
    """Return what the output was said to be, in order, from when the procedure first said it until it was on."""
    seen: list[str] = []

    def look() -> bool:
        found: str = snapshot(control, 1, 0, 0.0)["output"]
        if found != "unknown" or seen:
            seen.append(found)
        return found == "on"

    until(lambda: look() or not control.machine.busy)
    assert control.machine.busy, f"it ended before its output was on: {control.machine.last.why}"
    return list(dict.fromkeys(seen))


def is_measured_while_it_runs(control: Control) -> bool:
    """Whether the output of the procedure under way is known from its first gauge on, and comes to be on."""
    return set(until_on(control)) <= {"zero", "on"}
