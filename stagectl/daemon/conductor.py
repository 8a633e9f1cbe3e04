"""Between the daemon's desk and a run of the cell: whether it is to stop or to wait, and what it does meanwhile."""

from collections.abc import Mapping
from typing import Any

from rigkit.experiment.watch import Watch
from rigkit.service.rig import Desk
from rigkit.stop import Stopped

_OWN = ("started", "ended", "milled")
"""Events of a run's folder that a procedure tells in words of its own."""


class Conductor:
    """How a procedure of the cell is conducted.

    Parameters
    ----------
    desk : Desk
    sources : mapping of str to str
        Of its `Watch`.
    is_paced : bool
    """

    def __init__(self, desk: Desk, sources: Mapping[str, str], is_paced: bool) -> None:
        self.desk, self.watch = desk, Watch(sources, is_paced)
        self._stopped = False

    def stop(self) -> None:
        """Let what is under way retreat or hold, at its next look: from any thread."""
        self._stopped = True

    def stopped(self) -> bool:
        """Whether a STOP has come: then what is under way ends at once."""
        return self._stopped

    def ending(self) -> bool:
        """Whether it is to end, by a STOP or an abort."""
        return self._stopped or self.desk.ending()

    def between(self, where: Mapping[str, Any]) -> None:
        """Wait here while it is held; `where` is for the event log.

        Raises
        ------
        Stopped : it is to end.
        """
        if self.desk.held() and not self.ending():
            self.desk.event("held", where)
            self.desk.wait_while_held()
        if self.ending():
            raise Stopped("ended on request; the recording is stored")

    def heard(self, event: str, fields: Mapping[str, Any]) -> None:
        """Tell the desk of an event of a run's folder."""
        if event not in _OWN:
            self.desk.event(event, fields)
