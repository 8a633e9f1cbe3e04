"""Questions and answers between the web process and the rig's: JSON over a pipe, one at a time."""

import json
import threading
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from typing import Any

from rigkit.json_text import json_text

LARGEST = 50_000_000
"""Bytes of a message."""


ASKERS = 8
"""Threads that wait for answers of one end; only one of them asks at a time."""


class NoAnswer(TimeoutError):
    """The rig's process does not answer."""


class Asking:
    """The end that asks; any thread may.

    Parameters
    ----------
    pipe : Connection
    seconds : float, s
        Longest wait for an answer.
    """

    def __init__(self, pipe: Connection, seconds: float) -> None:
        self._pipe, self._seconds = pipe, seconds
        self._lock, self._number = threading.Lock(), 0
        self.threads = ThreadPoolExecutor(ASKERS, "asking")
        """For those who cannot wait themselves."""

    def ask(self, request: Mapping[str, Any]) -> dict[str, Any]:
        """Send a request and return the answer.

        Raises
        ------
        NoAnswer : none came within `seconds`.
        """
        if not self._lock.acquire(timeout=self._seconds):
            raise NoAnswer("the rig's process is busy")
        try:
            self._number += 1
            self._pipe.send_bytes(json_text({"number": self._number, **request}).encode())
            while self._pipe.poll(self._seconds):
                answer: dict[str, Any] = json.loads(self._pipe.recv_bytes(LARGEST))
                if answer["number"] == self._number:  # else that of a question nobody waits for any more
                    return answer
        except (EOFError, OSError):
            raise NoAnswer("the rig's process has ended") from None
        finally:
            self._lock.release()
        raise NoAnswer(f"the rig's process has not answered within {self._seconds:g} s")


def serve(pipe: Connection, answer: Callable[[Mapping[str, Any]], Mapping[str, Any]]) -> threading.Thread:
    """Answer what comes through the pipe, in a thread, until the other end is closed."""

    def loop() -> None:
        try:
            while True:
                request = json.loads(pipe.recv_bytes(LARGEST))
                answered = {"number": request["number"], **answer(request)}
                try:
                    content = json_text(answered)
                    encoded = content.encode()
                except (TypeError, ValueError, RecursionError) as fault:  # no JSON, or no text that can be sent
                    text = f"{type(fault).__name__}: {fault}"
                    encoded = json_text({"number": request["number"], "status": 500, "error": text}).encode()
                pipe.send_bytes(encoded)
        except (EOFError, OSError):
            pipe.close()

    thread = threading.Thread(target=loop, name="answers", daemon=True)
    thread.start()
    return thread
