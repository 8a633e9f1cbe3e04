"""The event log: the newest in memory for the page, all of them in a file, which nobody waits for."""

import json
import queue
import threading
from collections import deque
from collections.abc import Mapping
from datetime import UTC, datetime
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
        self._kept: deque[str] = deque(maxlen=KEPT)
        self.number = self.unwritten = 0
        """Number of the last event, and how many the disk has not taken."""
        self._fault = ""
        line_file.repair(path)
        self._waiting: queue.Queue[str | None] = queue.Queue(WAITING)
        self._writer = threading.Thread(target=self._write, name="journal", daemon=True)
        self._writer.start()

    def add(self, event: str, who: str, fields: Mapping[str, Any]) -> None:
        """Add an event: what, whose doing, and its particulars."""
        with self._lock:
            self.number += 1
            line = json_text({"number": self.number, "time": now(), "event": event, "who": who, **fields})
            self._kept.append(line)
            try:
                self._waiting.put_nowait(line)
            except queue.Full:
                self.unwritten += 1

    def since(self, number: int, most: int = KEPT) -> list[dict[str, Any]]:
        """Return the events after event `number` that are kept in memory, the newest `most` of them, in order."""
        with self._lock:
            wanted = max(0, min(most, self.number - number, len(self._kept)))
            found = [self._kept[place] for place in range(-wanted, 0)]
        return [json.loads(line) for line in found]

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
