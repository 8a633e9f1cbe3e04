"""Stop and kill a vibrator's daemon in mid-shot, and count the samples that are still played.

`python -m benchmarks.daemon_stops [TIMES]`; behind `chrt -f 10` it does not wait for other jobs.
"""

import itertools
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from tests.until import until
from tests.vibractl.daemon.killed import RATE, KilledDaemon, straight_daemon

TIMES = 8
LOUD = 0.3
"""V, of an amplitude of 1 V or so."""


def until_it_plays(daemon: KilledDaemon, run: str) -> None:
    """Begin a run, and return in the middle of a shot."""
    until(lambda: _is_at_rest(daemon), 60)
    daemon.log.unlink(missing_ok=True)
    daemon.command("arm")
    daemon.command("begin", run=run, shots=1000)
    until(lambda: daemon.log.exists() and bool(np.abs(daemon.drive()[-RATE // 20 :]).max(initial=0.0) > LOUD), 120)


def _is_at_rest(daemon: KilledDaemon) -> bool:
    """Whether the last that was told of a procedure is its end, or that the daemon has started."""
    told = [entry["event"] for entry in daemon.events() if entry["event"] in ("started", "run", "end")]
    return told[-1:] != ["run"] and bool(told)


def stopped(daemon: KilledDaemon, number: int) -> tuple[float, float]:
    """Return how long the drive went on after a STOP, and how long the answer took, s."""
    until_it_plays(daemon, f"stopped-{number}")
    with daemon.client() as client:
        client.snapshot()
        before, begin = daemon.written(), time.monotonic()
        client.stop("Bob", "a measurement")
        answered = time.monotonic() - begin
    until(lambda: _is_at_rest(daemon), 60)
    loud = np.flatnonzero(daemon.drive()[before:].any(axis=1))
    return float(loud[-1] + 1) / RATE if len(loud) else 0.0, answered


def main(times: int) -> None:
    """Measure, and print every figure."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with straight_daemon(folder, 0.1) as daemon:
            stops = [stopped(daemon, number) for number in range(times)]
        _print("STOP over HTTP, drive at zero after", [on for on, _ in stops])
        _print("STOP over HTTP, answered after", [answered for _, answered in stops])
        kills = []
        for number in range(times):
            with straight_daemon(folder, 0.1) as daemon:
                until_it_plays(daemon, f"killed-{number}")
                kills.append(daemon.kill())
        _print("SIGKILL, drive at zero after", kills)


def _print(title: str, seconds: list[float]) -> None:
    print(f"{title} {', '.join(f'{1e3 * each:.0f}' for each in sorted(seconds))} ms", flush=True)


if __name__ == "__main__":
    main(int(next(itertools.islice(sys.argv, 1, None), TIMES)))
