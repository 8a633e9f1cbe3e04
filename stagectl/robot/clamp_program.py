"""Soft servo and clamp, asked for without waiting: a thread of its own speaks with the robot's program."""

from collections.abc import Callable, Sequence
from queue import SimpleQueue
from threading import Thread
from typing import Self

from stagectl.link.bus import LinkError
from stagectl.robot.program import Program

_LONGEST_END = 2.0
"""s for the thread to end."""


class ClampProgram:
    """Asks for soft servo and clamp, and says when they are there: a context manager.

    Parameters
    ----------
    program : Program, open
    softness : sequence of float, 1
        Part of the position gain that soft servo takes away, a number a joint.
    fail : callable(reason)
        Called once when the program refuses or has gone, such as `RobotPort.hold`.
    """

    def __init__(self, program: Program, softness: Sequence[float], fail: Callable[[str], None]) -> None:
        self.is_soft = self.is_clamped = False
        self._asked_soft = self._asked_clamp = False
        self._program, self._softness, self._fail = program, tuple(softness), fail
        self._calls: SimpleQueue[Callable[[], None] | None] = SimpleQueue()
        self._thread = Thread(target=self._run, name="robot's program", daemon=True)

    def __enter__(self) -> Self:
        """Begin to speak."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End the thread; soft servo and clamp stay as they are."""
        self._calls.put(None)
        self._thread.join(_LONGEST_END)

    def want(self, soft: bool, clamp: bool) -> None:
        """Ask for what has not been asked for yet; may be called in every tick."""
        if soft != self._asked_soft:
            self._asked_soft = soft
            self._calls.put(self._soften if soft else self._stiffen)
        if clamp != self._asked_clamp:
            self._asked_clamp = clamp
            self._calls.put(self._close if clamp else self._open)

    def _run(self) -> None:
        while (call := self._calls.get()) is not None:
            try:
                call()
            except LinkError as fault:
                self._fail(str(fault))
                return

    def _soften(self) -> None:
        self._program.soften(self._softness)
        self.is_soft = True

    def _stiffen(self) -> None:
        self._program.soften((0.0,) * len(self._softness))
        self.is_soft = False

    def _close(self) -> None:
        self._program.clamp(True)
        self.is_clamped = True

    def _open(self) -> None:
        self._program.clamp(False)
        self.is_clamped = False
