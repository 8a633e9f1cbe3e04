"""Stop and kill a program that plays, and see how soon the relay in the amplifier's supply opens.

`python -m benchmarks.relay_drill [SECONDS]`: the simulated vibrator in real time, frames every 50 ms through an adapter
on a pseudo-terminal, a relay that waits 0.2 s for them.  First it only plays, for so many seconds.
"""

import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.rigkit.relay.listening import Heard, behind_an_adapter
from tests.vibractl.test_relay import ROOT, SESSION

PATIENCE = 0.2
DRILLS = 8
SECONDS = 60.0


def opened(heard: Heard, program: subprocess.Popen[str], number: int) -> float:
    """Send the program a signal while the relay is closed; return how long that takes to open it, s."""
    heard.until(closed=True)
    begun = time.monotonic()
    program.send_signal(number)
    heard.until(closed=False)
    return time.monotonic() - begun


def drill(seconds: float, number: int) -> tuple[float, int]:
    """Play for so long; return how long the relay took to open after a signal, s, and how often it opened before."""
    with tempfile.TemporaryDirectory() as folder, behind_an_adapter(Path(folder), PATIENCE) as (heard, _):
        command = [sys.executable, "-c", SESSION, folder]
        with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as program:
            heard.until(closed=True)
            before = heard.moves.count(False)
            time.sleep(seconds)
            early = heard.moves.count(False) - before
            took = opened(heard, program, number)
            program.kill()
    return took, early


def main(seconds: float) -> None:
    """Measure, and print."""
    _, early = drill(seconds, signal.SIGKILL)
    print(f"{seconds:g} s of playing: the relay opened {early} times")
    for name in ("SIGSTOP", "SIGKILL"):
        took = sorted(drill(1.0, signal.Signals[name])[0] for _ in range(DRILLS))
        print(f"{name} in mid-shot, {DRILLS} times: open after {1e3 * took[0]:.0f} to {1e3 * took[-1]:.0f} ms")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS)
