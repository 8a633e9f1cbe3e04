"""What the vibrator's daemon holds shot by shot, on the linear simulated vibrator as fast as it goes.

`python -m benchmarks.rig_growth [--shots 2000] [--from 1200] [--out FILE.csv]`: a run of hours in minutes; 5.5 MB of
disk a shot, taken away at the end.  The growth told is that from one shot on, which can be past the 1000th event.
"""

import argparse
import tempfile
import time
from itertools import pairwise
from pathlib import Path

from benchmarks.daemon_soak import Soak, daemon_on
from benchmarks.process_growth import HEAD, Held
from rigkit.service.config import Daemon
from vibractl.config import RigConfig, Simulator

EVERY = 5.0
"""s from one look to the next."""
SHOTS_A_DAY = 581 * 24
"""As many as an hour of the soak has, in real time."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--shots", type=int, default=2000)
    parser.add_argument("--from", type=int, default=1200, dest="since", help="shots that are not counted")
    parser.add_argument("--out", type=Path, default=Path("rig_growth.csv"))
    options = parser.parse_args()
    config = RigConfig(simulator=Simulator(speed=0.0), daemon=Daemon(mute_after=5.0))
    with tempfile.TemporaryDirectory() as name, daemon_on(Path(name), config) as daemon:
        soak = Soak(daemon, {})
        soak.calibrate()
        soak.keep_running(options.shots)
        begin = time.monotonic()
        with open(options.out, "w") as file:
            print(HEAD, file=file)
            while soak.state()[1]:
                for sample in soak.look(time.monotonic() - begin):
                    print(sample.row(), file=file, flush=True)
                time.sleep(EVERY)
        print(f"{daemon.named('fault') or 'no fault'}")
    own = [sample for sample in soak.samples if sample.process == "rig"]
    for first, last in ((options.since // 10, options.since), (options.since, options.shots)):
        print(told([sample for sample in own if first <= sample.shot < last]))  # then it is let go


def told(part: list[Held]) -> str:
    """Say how much more the last look has found than the first."""
    grown = (part[-1].rss - part[0].rss) / max(part[-1].shot - part[0].shot, 1)
    step = max((after.rss - before.rss for before, after in pairwise(part)), default=0.0)
    sizes = f"shot {part[0].shot} to {part[-1].shot}: {part[0].rss:.2f} to {part[-1].rss:.2f} MB"
    a_day = f"{1e3 * grown:.2f} kB a shot, {grown * SHOTS_A_DAY:.1f} MB a day in real time"
    return f"{sizes}, {a_day}; at most {step:.2f} MB at once"


if __name__ == "__main__":
    main()
