"""What a rig hands to the daemon: its procedures, its gauges, and how its output is brought to zero."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from rigkit.config import Section
from rigkit.faults import FaultTable
from rigkit.service.reload import Change
from rigkit.service.show import Gauge, Panel


class Desk(Protocol):
    """What a procedure has of the daemon while it runs.  Every method may be called from any thread, and is quick."""

    @property
    def who(self) -> str:
        """The person who began the procedure."""

    def ending(self) -> bool:
        """Whether the procedure is to end: at once after a STOP, else after the step under way."""

    def held(self) -> bool:
        """Whether it is to pause after the step under way."""

    def wait_while_held(self) -> None:
        """Return when it may go on, or is to end."""

    def begun(self) -> None:
        """Say that the procedure is made, and that nothing has refused it: the panels of the last one go."""

    def progress(self, done: float, total: float, note: str = "") -> None:
        """Say how much of the procedure is done, in its `unit`, and a word on how it goes."""

    def recording(self, on: bool) -> None:
        """Say whether what is measured is being kept."""

    def show(self, name: str, panel: Panel) -> None:
        """Put a panel in the place of the one of that name; the arrays are not changed afterwards."""

    def event(self, event: str, fields: Mapping[str, Any]) -> None:
        """Tell what has happened, for the event log; never waits for the disk."""


@dataclass(frozen=True)
class Procedure:
    """Something the rig can be told to do.

    Parameters
    ----------
    name, title : str
        For programs and for people.
    kind : "calibrate" or "run"
        Which state the rig is in meanwhile.
    unit : str
        What its progress is counted in, such as "shots".
    pausable : bool
        Whether it looks at `held`.
    on_pause, on_abort : str
        What happens then, in a sentence for the page.
    options : subclass of Section
        What it may be begun with; every key has a default.
    run : callable(desk, options)
        In a thread of its own.  It returns at its end, or soon after `ending` says so, with the output at zero.
        It is made within `making`.  Whatever it raises is a FAULT, except `rigkit.stop.Stopped`, and `NotBegun` there.
    """

    name: str
    title: str
    kind: Literal["calibrate", "run"]
    unit: str
    pausable: bool
    on_pause: str
    on_abort: str
    options: type[Section]
    run: Callable[[Desk, Any], None]


class Rig(Protocol):
    """A rig under the daemon.  Methods are called one at a time, except for `stop` and `gauges`."""

    program: str
    """The program's name, such as "vibractl"."""
    name: str
    """The rig's name."""

    faults: FaultTable | None
    """Where faults are put into its sensors on purpose; None where `daemon.faults` does not allow it."""

    @property
    def procedures(self) -> Sequence[Procedure]:
        """What it can be told to do."""

    def gauges(self) -> Sequence[Gauge]:
        """Return what is measured now: some microseconds, 25 times a second, from another thread.

        While a procedure runs, one at least is of the output: without any, the output counts as not measured.
        """

    def arm(self) -> None:
        """Get ready for a procedure; what is ready already stays so.

        Raises
        ------
        ValueError, OSError : it is not in order; it stays disarmed, and this is why.
        """

    def disarm(self) -> None:
        """Give up what `arm` has taken; nothing, where that is done already."""

    def stop(self) -> None:
        """Bring the output to zero now, whatever is under way: from any thread, and without waiting for anything."""

    def acknowledge(self, who: str) -> None:
        """Take back what latched in a fault, in the name of a person.

        Raises
        ------
        ValueError, OSError : it cannot be; the fault stays, and this is why.
        """

    def settings(self) -> str:
        """Return the settings in force, as TOML."""

    def edits(self) -> str:
        """Say how the rig file was edited since it was read, in a sentence; nothing where it was not."""

    def reload(self) -> Change:
        """Read the rig file again and do the least that makes what has changed hold.

        Raises
        ------
        ValueError, OSError : it cannot be used; the text names the key, and the settings in force stay.
        """

    def close(self) -> None:
        """Give up everything: the daemon ends."""
