"""What the daemon's web process holds while five pages draw every panel, ten new ones of each a second.

`python -m benchmarks.web_growth [--minutes 8]`: as many requests as an afternoon at a vibrator has.
"""

import argparse
import multiprocessing
import tempfile
import time
from pathlib import Path
from typing import Any

from benchmarks.daemon_soak import CLIENTS, SHARE, watch
from benchmarks.process_growth import held, table
from tests.rigkit.service.served import served

EVERY = 5.0
"""s from one look to the next."""
STEP = 0.1
"""s of a step of the demonstration; each draws its panels anew."""


def page(address: str, token: str, cuts: Any) -> None:
    def cut() -> None:
        cuts.value += 1

    watch(address, token, lambda: None, cut, 0.0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=8.0)
    seconds = 60.0 * parser.parse_args().minutes
    context = multiprocessing.get_context("fork")
    cuts, found = context.Value("i", 0), []
    with tempfile.TemporaryDirectory() as place, served(Path(place), requests=1000.0) as daemon:
        daemon.begin(steps=100_000, seconds=STEP)
        given = daemon.settings.address, daemon.tokens.view, cuts
        pages = [context.Process(target=page, args=given, daemon=True) for _ in range(CLIENTS)]
        for each in pages:
            each.start()
        begun = time.monotonic()
        while (now := time.monotonic() - begun) < seconds:
            found += [held(name, pid, now, 0) for name, pid in (("rig", daemon.process.pid), ("web", daemon.web))]
            time.sleep(EVERY)
        for each in pages:
            each.terminate()
    print(f"{seconds / 60:g} min, {CLIENTS} pages, cut off {cuts.value} times")
    print("\n".join(table(found, (1 - SHARE) * seconds)))


if __name__ == "__main__":
    main()
