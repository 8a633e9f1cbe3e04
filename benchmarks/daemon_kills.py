"""Kill a vibrator's daemon at random moments in every state, see that all is whole, and how long the drive goes on.

`python -m benchmarks.daemon_kills [TIMES]`; ten seconds each.
"""

import itertools
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from tests.vibractl.daemon.kills import STATES, kills

TIMES = 200


def main(times: int) -> None:
    """Kill, and print what was found in each state."""
    begin, found = time.monotonic(), []
    with tempfile.TemporaryDirectory() as folder:
        for count, (state, seconds) in enumerate(kills(Path(folder), times), start=1):
            found.append((state, 1e3 * seconds))
            print(f"{count} {state} {1e3 * seconds:.0f} ms", file=sys.stderr, flush=True)
    load = os.getloadavg()[2]
    print(f"{times} kills in {time.monotonic() - begin:.0f} s, load average {load:.1f}: every file whole each time")
    for state in dict.fromkeys(STATES):
        played = [after for name, after in found if name == state and after]
        kills_in = sum(name == state for name, _ in found)
        if played:
            middle, most = np.median(played), max(played)
            print(f"  {state}: {kills_in} kills; drive on in {len(played)}, for {middle:.0f} ms, at most {most:.0f} ms")
        else:
            print(f"  {state}: {kills_in} kills, drive on in none")


if __name__ == "__main__":
    main(int(next(itertools.islice(sys.argv, 1, None), TIMES)))
