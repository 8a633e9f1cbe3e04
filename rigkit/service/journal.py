"""The event log: the newest in memory for the page, all of them in a file, which nobody waits for."""

import json
import queue
import threading
from collections.abc import Mapping
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path
from typing import Any

from rigkit import line_file
from rigkit.json_text import json_text

KEPT = 1000
"""Events in memory."""
WAITING = 1000
"""Events that may wait for the disk; more are counted and not written."""
LARGEST = 10_000_000
"""Bytes of the file, which then becomes `.1`, in the place of the one before."""


def now() -> str:
    """Return the time, UTC, to the millisecond."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


class Journal:
    """What has happened, numbered from 1.  `add` may be called from any thread and never waits for the disk.

    Parameters
    ----------
    path : Path
        A file that grows by a line of JSON for each event; a line that a kill cut short is taken away.
    """

    def __init__(self, path: Path) -> None:
        self._path, self._lock = path, threading.Lock()
        self._kept: dict[int, str] = {}
        self.number = self.unwritten = 0
        """Number of the last event, and how many the disk has not taken."""
        self._fault = ""
        line_file.repair(path)
        self._waiting: queue.Queue[str | None] = queue.Queue(WAITING)
        self._writer = threading.Thread(target=self._write, name="journal", daemon=True)
        self._writer.start()

    def add(self, event: str, who: str, fields: Mapping[str, Any], instead_of: int = 0) -> int:
        """Add an event, and return its number.

        Parameters
        ----------
        event, who : str
            What, and whose doing.
        fields : mapping
            Its particulars.
        instead_of : int
            Number of an event whose place in memory it takes, as it tells the same and more; in the file both stay.
        """
        with self._lock:
            self.number += 1
            line = json_text({"number": self.number, "time": now(), "event": event, "who": who, **fields})
            self._kept.pop(instead_of, None)
            self._kept[self.number] = line
            if len(self._kept) > KEPT:
                del self._kept[next(iter(self._kept))]
            try:
                self._waiting.put_nowait(line)
            except queue.Full:
                self.unwritten += 1
            return self.number

    def since(self, number: int, most: int = KEPT) -> list[dict[str, Any]]:
        """Return the events after event `number` that are kept in memory, the newest `most` of them, in order."""
        with self._lock:
            found = [self._kept[place] for place in islice(reversed(self._kept), most) if place > number]
        return [json.loads(line) for line in reversed(found)]

    @property
    def fault(self) -> str:
        """Why events are not on the disk; empty where they are."""
        return self._fault or (f"{self.unwritten} events are not on the disk" if self.unwritten else "")

    def close(self, seconds: float = 2.0) -> None:
        """Wait up to `seconds` for the disk, and end."""
        try:
            self._waiting.put(None, timeout=seconds)
        except queue.Full:
            return
        self._writer.join(seconds)

    def _write(self) -> None:
        while (line := self._waiting.get()) is not None:
            try:
                if self._path.exists() and self._path.stat().st_size > LARGEST:
                    self._path.replace(self._path.with_name(f"{self._path.name}.1"))
                line_file.append(self._path, line)
                self._fault = ""
            except OSError as fault:
                self.unwritten += 1
                self._fault = f"{self._path}: {fault.strerror or fault}"
