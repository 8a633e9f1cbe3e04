"""What the vibrator's daemon holds shot by shot, on the linear simulated vibrator as fast as it goes.

`python -m benchmarks.rig_growth [--shots 2000] [--from 1200] [--out FILE.csv]`: a run of hours in minutes; 5.5 MB of
disk a shot, taken away at the end.  The growth told is that from one shot on, which can be past the 1000th event.
"""

import argparse
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from benchmarks.daemon_soak import Soak, daemon_on
from benchmarks.process_growth import HEAD, table
from rigkit.service.config import Daemon
from vibractl.config import RigConfig, Simulator

EVERY = 5.0
"""s from one look to the next."""
SHOT = 3600.0 / 581
"""s from one shot to the next in real time, as in an hour of the soak."""


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
                soak.look(time.monotonic() - begin, file)
                time.sleep(EVERY)
        print(f"{daemon.named('fault') or 'no fault'}")
    played = [replace(each, seconds=each.shot * SHOT) for each in soak.samples if each.shot < options.shots]
    for first, last in ((options.since // 10, options.since), (options.since, options.shots)):
        print(f"shot {first} to {last}, by the clock of shots in real time:")
        print("\n".join(table([each for each in played if each.shot < last], first * SHOT)))


if __name__ == "__main__":
    main()
