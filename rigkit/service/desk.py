"""What a procedure tells, kept for whoever asks: progress, panels, recording light, and whether it is to end."""

import threading
import time
from collections.abc import Mapping
from typing import Any, Literal

from rigkit.service.journal import Journal
from rigkit.service.rig import Procedure
from rigkit.service.show import Panel

Outcome = Literal["getting ready", "begun", "not begun", "failed"]


class Board:
    """The panels as they stand; each has a revision that moves on with it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._panels: dict[str, tuple[int, Panel]] = {}
        self._revision = 0

    def show(self, name: str, panel: Panel) -> None:
        """Put a panel in the place of the one of that name."""
        with self._lock:
            self._revision += 1
            self._panels[name] = self._revision, panel

    def clear(self) -> None:
        """Take all panels away: another procedure begins.  Revisions go on, so that none comes twice."""
        with self._lock:
            self._panels.clear()

    def revisions(self) -> dict[str, int]:
        """Return what panels there are, and their revisions."""
        with self._lock:
            return {name: revision for name, (revision, _) in self._panels.items()}

    def panel(self, name: str) -> dict[str, Any]:
        """Return a panel as JSON has it.

        Raises
        ------
        LookupError : there is none of that name.
        """
        with self._lock:
            if name not in self._panels:
                raise LookupError(f"there is no panel {name!r}; there are {', '.join(self._panels) or 'none yet'}")
            revision, panel = self._panels[name]
        return {"name": name, "revision": revision, **panel.plain()}


class OpenDesk:
    """The desk of one procedure, from its begin to its end.

    Parameters
    ----------
    procedure : Procedure
    who : str
    board : Board
    journal : Journal
    """

    def __init__(self, procedure: Procedure, who: str, board: Board, journal: Journal) -> None:
        self.procedure, self.who = procedure, who
        self._board, self._journal = board, journal
        self._moved = threading.Condition()
        self._ending = self._held = self.is_recording = False
        self._done, self._total, self._note = 0.0, 0.0, ""
        self._began: tuple[float, float] | None = None
        self._waited = 0.0
        self._shown: dict[str, Panel] | None = {}
        """Panels that wait for the procedure to have begun; None once it has."""
        self.outcome: Outcome = "getting ready"
        """What came of the wish to begin it ..."""
        self.why = ""
        """... and why, where that was nothing."""

    def ending(self) -> bool:
        """Whether the procedure is to end."""
        return self._ending

    def held(self) -> bool:
        """Whether it is to pause after the step under way."""
        return self._held

    def wait_while_held(self) -> None:
        """Return when it may go on, or is to end."""
        since = time.monotonic()
        with self._moved:
            self._moved.wait_for(lambda: self._ending or not self._held)
        self._waited += time.monotonic() - since

    def begun(self) -> None:
        """Take the panels of the last procedure away, and show those of this one."""
        with self._moved:
            shown, self._shown = self._shown, None
            if shown is None:
                return
            self._board.clear()
            for name, panel in shown.items():
                self._board.show(name, panel)
            self.outcome = "begun"

    def end_as(self, outcome: Outcome, why: str) -> None:
        """Say what came of it where it never came to `begun`; else that is what came of it."""
        with self._moved:
            if self.outcome == "getting ready":
                self.outcome, self.why = outcome, why

    def progress(self, done: float, total: float, note: str = "") -> None:
        """Say how much is done."""
        if self._began is None:
            self._began = time.monotonic(), done
        self._done, self._total, self._note = done, total, note

    def recording(self, on: bool) -> None:
        """Say whether what is measured is being kept."""
        self.is_recording = on

    def show(self, name: str, panel: Panel) -> None:
        """Show a panel, as soon as the procedure has begun."""
        with self._moved:
            if self._shown is None:
                self._board.show(name, panel)
            else:
                self._shown[name] = panel

    def event(self, event: str, fields: Mapping[str, Any]) -> None:
        """Tell what has happened."""
        self._journal.add(event, self.procedure.name, fields)

    def hold(self, on: bool) -> None:
        """Ask the procedure to pause, or to go on."""
        with self._moved:
            self._held = on
            self._moved.notify_all()

    def end(self) -> None:
        """Ask it to end."""
        with self._moved:
            self._ending = True
            self._moved.notify_all()

    def plain(self) -> dict[str, Any]:
        """Return how it stands, as JSON has it."""
        procedure = self.procedure
        return {
            "name": procedure.name,
            "title": procedure.title,
            "who": self.who,
            "done": self._done,
            "total": self._total,
            "unit": procedure.unit,
            "note": self._note,
            "seconds_left": self._seconds_left(),
            "pausable": procedure.pausable,
            "held": self._held,
            "ending": self._ending,
            "on_pause": procedure.on_pause,
            "on_abort": procedure.on_abort,
        }

    def _seconds_left(self) -> float | None:
        if self._began is None or self._done <= self._began[1]:
            return None
        since, start = self._began
        elapsed = time.monotonic() - since - self._waited
        return elapsed * (self._total - self._done) / (self._done - start)
