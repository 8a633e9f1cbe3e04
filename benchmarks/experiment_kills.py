"""Kill runs of every experiment at random moments; see that all but the last half second is there, and goes on.

`python -m benchmarks.experiment_kills [KIND ...] [--kills 30] [--seed 1]`; some twenty seconds each.
"""

import argparse
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from tests.stagectl.experiments.experiment_kills import COMMANDS, kills


def main() -> None:
    """Kill, and print what was found of each kind."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=", ".join(COMMANDS))
    parser.add_argument("--kills", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    if unknown := [kind for kind in given.kinds if kind not in COMMANDS]:
        parser.error(f"{unknown[0]} is no kind of run; it must be one of {', '.join(COMMANDS)}")
    for kind in given.kinds or COMMANDS:
        begin, found = time.monotonic(), Counter[str]()
        with tempfile.TemporaryDirectory() as folder:
            for number, each in enumerate(kills(kind, Path(folder), given.kills, given.seed), start=1):
                found[each.outcome] += 1
                print(f"{kind} {number}: killed after {each.after:.2f} s: {each.outcome}", file=sys.stderr, flush=True)
        told = ", ".join(f"{count} {outcome}" for outcome, count in found.most_common())
        print(f"{kind}: {given.kills} kills in {time.monotonic() - begin:.0f} s: {told}", flush=True)


if __name__ == "__main__":
    main()
