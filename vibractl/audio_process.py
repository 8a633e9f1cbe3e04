"""The audio stream in a process of its own, which no Python work elsewhere can hold up, and which outlives nobody."""

import contextlib
import gc
import multiprocessing
import os
import signal
import sys
from multiprocessing.connection import wait

from rigkit.faults import FaultTable
from rigkit.patience import Patience, processor_time
from rigkit.priority import all_real_time
from vibractl.audio_engine import POLL, Engine
from vibractl.audio_memory import Memory, Word
from vibractl.audio_stream import AudioError
from vibractl.config import RigConfig

STAGES = "imports its modules", "compiles its kernels", "opens the stream"
"""On the way to a stream that runs."""
_LONGEST_IDLE, _SIGN = 60.0, 0.1
"""s in which the process must have used so much processor time, s, on that way: a slow machine is waited for."""
_LONGEST_WORK = 600.0
"""s of processor time that it may use there."""
_LONGEST_END = 10.0
"""s for it to ramp down and close the stream."""
_REST = 0.05
"""s that the waiting thread leaves the interpreter alone, beside a stream with a clock of its own."""
_SWITCH = 1e-4
"""s after which the callback's thread gets the interpreter from the waiting one."""


class AudioProcess:
    """An `Engine` in a child process: the same methods, the same memory.

    When this process dies the child fades to zero, closes the stream and ends; when the child dies, `serve` says so.

    Parameters
    ----------
    config : RigConfig
    memory : Memory
    faults : FaultTable or None
    """

    def __init__(self, config: RigConfig, memory: Memory, faults: FaultTable | None = None) -> None:
        self._memory = memory
        context = multiprocessing.get_context("spawn")
        self._process = context.Process(target=run, args=(config, memory, faults), name="audio", daemon=True)

    @property
    def pid(self) -> int | None:
        """Number of the child process, once started."""
        return self._process.pid

    def start(self) -> None:
        """Start the process and wait until its stream runs.

        Raises
        ------
        AudioError : it cannot be opened, or the process has died.
        """
        self._process.start()
        patience = Patience(_LONGEST_IDLE, _SIGN)
        while not self._memory.words[Word.READY]:
            if self._memory.words[Word.FAULT]:
                self._process.join(_LONGEST_END)
                raise AudioError(self._memory.text)
            used = processor_time(self._process.pid or 0)
            if patience.is_over(used):
                raise AudioError(f"the audio process has not responded for {_LONGEST_IDLE:g} s while it {self._stage}")
            if used > _LONGEST_WORK:
                raise AudioError(f"the audio process still {self._stage}, after {used:.0f} s of processor time")
            self.serve()

    @property
    def _stage(self) -> str:
        return STAGES[self._memory.words[Word.STAGE]]

    def serve(self) -> None:
        """Wait a moment, and see that the child lives."""
        self._process.join(POLL)
        if self._process.exitcode is not None and not self._memory.words[Word.FAULT]:
            self._memory.text = f"the audio process {self._process.pid} has died, exit code {self._process.exitcode}"
            self._memory.words[Word.FAULT] = 1

    def close(self) -> None:
        """Let the child, if its stream runs, ramp down and close it; end a child that does not, or has none yet."""
        if self._process.pid is None:
            return
        self._memory.words[Word.END] = 1
        if self._memory.words[Word.READY]:
            self._process.join(_LONGEST_END)
        if self._process.exitcode is None:
            self._process.kill()
            self._process.join()


def run(config: RigConfig, memory: Memory, faults: FaultTable | None) -> None:
    """Run the stream until the program wants its end, or is gone: the child process' whole life.

    Parameters
    ----------
    config : RigConfig
    memory : Memory
    faults : FaultTable or None
    """
    words = memory.words
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the program, which then ramps down
    signal.signal(signal.SIGTERM, lambda *_: words.__setitem__(Word.END, 1))
    sys.setswitchinterval(_SWITCH)
    try:
        words[Word.STAGE] = STAGES.index("compiles its kernels")
        engine = Engine(config, memory, faults)
        gc.collect()
        gc.freeze()
        gc.disable()
        words[Word.STAGE] = STAGES.index("opens the stream")
        engine.start()
    except Exception as fault:
        memory.text = str(fault) if isinstance(fault, ValueError | OSError) else f"{type(fault).__name__}: {fault}"
        words[Word.FAULT] = 1
        return
    with contextlib.nullcontext() if engine.stepped else all_real_time():  # the callback's thread among them
        parent = multiprocessing.parent_process()
        while not (words[Word.END] or words[Word.FAULT]) and parent is not None and parent.is_alive():
            engine.serve()
            wait([parent.sentinel], 0.0 if engine.stepped else _REST)  # its end wakes this at once
        engine.close()
    if words[Word.FAULT]:
        os._exit(1)  # what an interpreter does at its end hangs in PortAudio when the audio server is gone
