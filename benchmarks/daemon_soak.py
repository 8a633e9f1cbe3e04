"""Leave a vibrator's daemon alone for an hour on a real audio server, recording and watched, and see what grows.

`python -m benchmarks.daemon_soak [--minutes 60] [--out FILE.csv]`; as root, the server asks for real-time priority.
The vibrator is calibrated through the daemon first, in a minute more.
"""

import argparse
import multiprocessing
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread
from typing import Any, TextIO

from benchmarks.audio_load import stolen
from benchmarks.jack_server import jack_server, missing, vibrator_client
from benchmarks.process_growth import HEAD, Held, held, table
from rigkit import config as rig_file
from rigkit.run_folder import read_quality
from rigkit.service.client import Client, DaemonError
from rigkit.service.config import Daemon
from tests.rigkit.service.served import ROOT, Served, answering, free_port, offspring
from tests.until import until
from vibractl.config import Audio, RigConfig, Simulator

EVERY = 10.0
"""s from one look to the next."""
CLIENTS = 5
BETWEEN_PANELS = 0.5
"""s from one panel that a client asks for to its next."""
AGAIN = 1.0
"""s until a client that was cut off begins anew, as the page does."""
SHARE = 2 / 3
"""Of the time, at its end, over which growth is told."""
MANY = 2_000
"""Shots of a run: more than an hour's, less than 11 GB."""


def watch(
    address: str, token: str, count: Callable[[], None], cut: Callable[[], None], between: float = BETWEEN_PANELS
) -> None:
    """Be a page: watch, and where it was cut off begin anew; `between` s from one panel to the next."""
    while True:
        try:
            look(address, token, count, between)
        except (DaemonError, OSError):
            cut()
            time.sleep(AGAIN)


def look(address: str, token: str, count: Callable[[], None], between: float) -> None:
    """Read every snapshot, and each panel that has changed, one at a time."""
    seen: dict[str, int] = {}
    asked = time.monotonic()
    with Client(address, token) as client:
        for shown in client.watch():
            count()
            news = [name for name, revision in shown["panels"].items() if seen.get(name) != revision]
            if news and time.monotonic() - asked > between:
                asked = time.monotonic()
                oldest = min(news, key=lambda name: seen.get(name, 0))
                seen[oldest] = client.panel(oldest)["revision"]


def crowd(address: str, token: str, counts: Any) -> None:
    """Be all the clients, in a process of its own; count what each is sent, and behind that how often it is cut off."""

    def counting(number: int) -> Callable[[], None]:
        return lambda: counts.__setitem__(number, counts[number] + 1)

    threads = [
        Thread(target=watch, args=(address, token, counting(number), counting(CLIENTS + number)))
        for number in range(CLIENTS)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def audible(period: int) -> RigConfig:
    """Return the settings of a rig on the audio server that runs."""
    return RigConfig(
        audio=Audio(stream="sounddevice:Stream", device="shaker", blocksize=period, attempts=20),
        simulator=Simulator(speed=1.0),
        daemon=Daemon(mute_after=max(0.1, 0.06 + 2 * period / 44_100)),
    )


@contextmanager
def daemon_on(folder: Path, config: RigConfig) -> Iterator[Served]:
    """Start `vibractl daemon` at an address of its own, with its data below `folder`."""
    place = {"address": f"127.0.0.1:{free_port()}", "data": str(folder / "data")}
    config = config.model_copy(update={"daemon": config.daemon.model_copy(update=place)})
    (folder / "rig.toml").write_text(rig_file.dump(config))
    command = [sys.executable, "-m", "vibractl", "daemon", "--config", str(folder / "rig.toml")]
    process = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)
    with answering(Served(config.daemon, process)) as made:
        yield made


class Soak:
    """A daemon that runs and runs, and what its processes held meanwhile.

    Parameters
    ----------
    daemon : Served
    others : mapping, name to process number
        Looked at beside the daemon's own.
    """

    def __init__(self, daemon: Served, others: dict[str, int]) -> None:
        self.daemon, self.web = daemon, daemon.web
        self._others = others
        self.samples: list[Held] = []
        self.run = 0

    def begin(self, procedure: str, **options: object) -> None:
        """Arm where that is needed, and begin a procedure."""
        with self.daemon.client() as client, client.control("Ada", over=True):
            if client.snapshot()["state"]["name"] == "DISARMED":
                client.command("arm", "a soak")
            client.begin(procedure, **options)

    def calibrate(self) -> None:
        """Identify the vibrator, as a run needs it."""
        self.begin("calibrate")
        until(lambda: self.daemon.named("end"), 900)
        time.sleep(1.0)  # for the snapshot to say so
        assert self.state() == ("ARMED", False), self.daemon.named("fault")

    def state(self) -> tuple[str, bool]:
        """Return the rig's state, and whether a procedure is under way."""
        with self.daemon.client() as client:
            shown = client.snapshot()
        return shown["state"]["name"], shown["procedure"] is not None

    def shots(self) -> list[dict[str, str]]:
        """Return the quality of every shot of every run."""
        runs = sorted((Path(self.daemon.settings.data) / "runs").glob("soak-*"))
        return [row for run in runs if (run / "qc.csv").exists() for row in read_quality(run)]

    def keep_running(self, shots: int) -> None:
        """Begin the next run where the one before has ended."""
        if not self.state()[1]:
            self.run += 1
            self.begin("run", run=f"soak-{self.run:04d}", shots=shots)

    def look(self, seconds: float, file: TextIO) -> None:
        """Look at every process once, and add what each holds to a file of CSV."""
        done, pids = len(self.shots()), {"rig": self.daemon.process.pid, "web": self.web}
        for pid in offspring(self.daemon.process.pid):
            if pid != self.web and b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes():
                pids["audio"] = pid
        for name, pid in (pids | self._others).items():
            try:
                sample = held(name, pid, seconds, done)
            except OSError:
                continue  # between two runs
            self.samples.append(sample)
            print(sample.row(), file=file)
        file.flush()


def main() -> None:
    """Read the options, soak, and print what was found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--period", type=int, default=2048)
    parser.add_argument("--shots", type=int, default=MANY, help="of a run; then the next begins")
    parser.add_argument("--sync", action="store_true", help="jackd -S: late moves time and not data")
    parser.add_argument("--out", type=Path, default=Path("daemon_soak.csv"))
    options = parser.parse_args()
    if missing():
        raise SystemExit(f"skipped: {missing()}")
    server = ["-R", "-P70", *(["-S"] if options.sync else [])]
    with tempfile.TemporaryDirectory() as name, open(Path(name) / "jackd.log", "w+") as log:
        with jack_server(server, 44_100, options.period, log) as jackd, vibrator_client([]) as shaker:
            with daemon_on(Path(name), audible(options.period)) as daemon:
                soak = Soak(daemon, {"jackd": jackd.pid, "shaker": shaker.pid})
                soaked(soak, options.minutes * 60, options.shots, options.out)
                log.seek(0)
                xruns = log.read().lower().count("xrun")
    print(f"  {xruns} xruns in the log of jackd {' '.join(server)} -p {options.period}")


def soaked(soak: Soak, seconds: float, shots: int, out: Path) -> None:
    """Calibrate, run for so long with everybody watching, and print the table."""
    soak.calibrate()
    context = multiprocessing.get_context("spawn")
    counts = context.Array("q", 2 * CLIENTS, lock=False)
    address, token = soak.daemon.settings.address, soak.daemon.tokens.view
    watching = context.Process(target=crowd, args=(address, token, counts), daemon=True)
    watching.start()
    with soak.daemon.client() as client:
        first = client.snapshot()
    begin, taken = time.monotonic(), stolen()
    with open(out, "w") as file:
        print(HEAD, file=file)
        for number in range(round(seconds / EVERY) + 1):
            until(lambda number=number: time.monotonic() - begin >= number * EVERY, 2 * EVERY)  # type: ignore[misc]
            if soak.daemon.named("fault"):
                break
            soak.keep_running(shots)
            soak.look(time.monotonic() - begin, file)
    taken = stolen() - taken
    with soak.daemon.client() as client:
        last = client.snapshot()
    received, cut = counts[:CLIENTS], sum(counts[CLIENTS:])
    watching.kill()
    watching.join()
    tell(soak, first, last, received, cut)
    print(f"  taken from this machine by its host meanwhile: {taken:.1f} s of processor time")
    for line in table(soak.samples, (1 - SHARE) * soak.samples[-1].seconds):
        print(f"  {line}", flush=True)


def tell(soak: Soak, first: dict[str, Any], last: dict[str, Any], received: list[int], cut: int) -> None:
    """Print what came of the shots and of the clients, between two snapshots."""
    rows = soak.shots()
    flags = {name: sum(int(row[name]) for row in rows) for name in ("input_xruns", "output_xruns", "late")}
    print(f"{soak.samples[-1].seconds / 60:.1f} min, {len(rows)} shots in {soak.run} runs, {flags}")
    made, late = last["tick"] - first["tick"], last["late_ticks"] - first["late_ticks"]
    for word in ("discarded", "fault", "web process died"):
        told = soak.daemon.named(word)
        print(f"  {word}: {len(told)} {'; '.join(entry.get('reason') or entry.get('why', '') for entry in told)}")
    had = f"{CLIENTS} clients had {min(received)} to {max(received)} of them, cut off {cut} times"
    print(f"  {made} snapshots, {late} late; {had}")


if __name__ == "__main__":
    main()
