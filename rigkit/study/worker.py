"""A process that performs tasks one after the other: the imports and compiled loops of one serve the next.

`python -m rigkit.study.worker FILES SCRATCH` reads a task a line on its standard input and writes an outcome a line on
its standard output; before the first, what it is.  It ends, with every process that it started, when its input does,
and where a command was stopped by its user: the task is then begun again by another.
"""

import os
import platform
import signal
import sys
import traceback
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from typing import BinaryIO

import numpy as np
from threadpoolctl import threadpool_info

from rigkit import machine_facts
from rigkit.command import STOPPED
from rigkit.json_file import json_value
from rigkit.json_text import json_text
from rigkit.provenance import software
from rigkit.study.performing import perform
from rigkit.study.task import Task

_INPUT, _OUTPUT, _ERROR = 0, 1, 2


def main() -> None:
    """Perform tasks until there are no more."""
    if os.getpgrp() != os.getpid():
        os.setpgid(0, 0)  # what it kills in the end is its own
    files, scratch = (Path(each) for each in sys.argv[1:])
    tasks, results = _private_pipes()
    lines: SimpleQueue[bytes] = SimpleQueue()
    Thread(target=_read, args=(tasks, lines), daemon=True).start()
    _send(results, json_text({"software": software(), "host": platform.node(), "processor": processor()}))
    while True:
        task = Task.of(json_value(lines.get().decode(), "a task", dict))
        outcome = perform(task, files, scratch)
        if outcome.status == STOPPED:  # by a signal to this process, which says nothing of the task
            os.killpg(0, signal.SIGKILL)
        _send(results, outcome.text)


def processor() -> str:
    """Say which processor this is, and for which one the linear algebra has been chosen.

    Results are equal bit for bit where both are.
    """
    np.linalg.inv(np.eye(2))
    kinds = {str(library.get("architecture", "")) for library in threadpool_info()}
    return f"{machine_facts.processor()} ({', '.join(sorted(filter(None, kinds)))})"


def _private_pipes() -> tuple[BinaryIO, BinaryIO]:
    """Take the pipes away from what tasks read and write, and give them an empty input and no output."""
    pipes = os.fdopen(os.dup(_INPUT), "rb"), os.fdopen(os.dup(_OUTPUT), "wb")
    nothing = os.open(os.devnull, os.O_RDWR)
    for each in (_INPUT, _OUTPUT):
        os.dup2(nothing, each)
    return pipes


def _read(tasks: BinaryIO, lines: SimpleQueue[bytes]) -> None:
    """Pass on every line; when the one who sends them is gone, end this process and all that it started."""
    for line in tasks:
        lines.put(line)
    os.killpg(0, signal.SIGKILL)


def _send(results: BinaryIO, text: str) -> None:
    results.write(text.encode() + b"\n")
    results.flush()


if __name__ == "__main__":
    try:
        main()
    except BaseException:
        traceback.print_exc()
        os.killpg(0, signal.SIGKILL)
