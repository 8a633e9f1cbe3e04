"""The daemon is killed in mid-run, at random moments and in every state: nothing is broken, and the drive falls silent.

`make soak` kills 200 times; each time the run goes on from what is there.
"""

import random
import threading
from pathlib import Path

import numpy as np
import pytest

from ctlblocks import recording
from rigkit import atomic
from rigkit.run_folder import RunFolder, read_events, read_quality
from tests.rigkit.service.until import until
from tests.vibractl.daemon.killed import KilledDaemon, straight_daemon
from vibractl.session import shot_files

PATIENCE = threading.Event()


def whole(path: Path, least: int) -> int:
    """Return how many shots a run's folder holds; each is there whole, and so is all beside them."""
    with RunFolder.open(path):  # sweeps up what was being written
        assert list(atomic.leftovers(path)) == []
    files, rows = shot_files(path), read_quality(path)
    lengths = {len(recording.read(file).data) for file in files}
    assert len(lengths) <= 1
    assert len(files) >= least
    assert len(files) - len(rows) in (0, 1)
    read_events(path)
    return len(files)


def kill_in(daemon: KilledDaemon, folder: Path, state: str, moment: float) -> float:
    """Bring a daemon to a state, wait for a moment, and kill it; return for how long the drive went on, s."""
    with daemon.client() as client:
        assert client.snapshot()["state"]["name"] == "DISARMED"
    run = folder / "data" / "runs" / "one"
    done = 0
    if state != "DISARMED":
        daemon.command("arm")
    if state in ("RUNNING", "PLAYING", "HOLD"):
        daemon.command("begin", run="one", resume=run.exists(), shots=1000)
    if state == "HOLD":
        daemon.command("hold")
    if state == "FAULT":
        daemon.command("begin", run="two", model="none.h5")
        until(lambda: daemon.named("fault"), 60)
    if state == "PLAYING":
        until(lambda: daemon.log.exists() and daemon.drive().any(), 120)
    PATIENCE.wait(moment)
    if run.exists():
        done = daemon.done()
    still = daemon.kill()
    if run.exists():
        whole(run, done)
    return still


def kills(folder: Path, number: int) -> list[float]:
    """Kill so many times; return for how long the drive went on each time, s."""
    chance, gone_on = random.Random(5), []
    for count in range(number):
        state = ("PLAYING", "RUNNING", "PLAYING", "HOLD", "PLAYING", "ARMED", "FAULT", "DISARMED")[count % 8]
        (folder / "log").unlink(missing_ok=True)
        if count % 20 == 19:  # going on with a run takes longer with every shot of it
            (folder / "data" / "runs" / "one").rename(folder / "data" / "runs" / f"one-{count}")
            (folder / "data" / "events.jsonl").unlink()
        with straight_daemon(folder) as daemon:
            gone_on.append(kill_in(daemon, folder, state, chance.uniform(0.0, 6.0)))
    return gone_on


def test_a_daemon_killed_while_it_plays_falls_silent_and_goes_on_where_it_was(tmp_path: Path) -> None:
    with straight_daemon(tmp_path) as daemon:
        daemon.command("arm")
        daemon.command("begin", run="one", shots=1000)
        until(lambda: daemon.done() >= 1 and np.abs(daemon.drive()[-2000:]).max() > 0.3, 90)
        assert daemon.kill() < 1.0
        drive = daemon.drive()
        assert not drive[-10:].any()
        assert np.abs(np.diff(drive, axis=0)).max() * 44_100 < 20_000
    shots = whole(tmp_path / "data" / "runs" / "one", 1)
    with straight_daemon(tmp_path) as daemon:
        with daemon.client() as client:
            assert client.snapshot()["state"]["name"] == "DISARMED"
        daemon.command("arm")
        daemon.command("begin", run="one", resume=True, shots=shots + 1)
        until(lambda: daemon.named("finished"), 90)
    assert whole(tmp_path / "data" / "runs" / "one", shots + 1) == shots + 1


@pytest.mark.slow
def test_a_daemon_killed_two_hundred_times(tmp_path: Path) -> None:
    gone_on = kills(tmp_path, 200)
    played = [seconds for seconds in gone_on if seconds]
    assert len(played) > 40
    assert np.median(played) < 0.1
