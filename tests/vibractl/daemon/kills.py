"""A daemon that is killed at random moments in every state, and what must be whole afterwards."""

import random
import shutil
import threading
from collections.abc import Iterator
from pathlib import Path

from calibration.names import raw_folder
from ctlblocks import recording
from rigkit import atomic
from rigkit import config as rig_file
from rigkit.run_folder import RunFolder, read_events, read_quality
from rigkit.service.daemon import EVENTS
from tests.until import until
from tests.vibractl.daemon.killed import KilledDaemon, straight_daemon
from vibractl.config import RigConfig
from vibractl.run_setup import shot_files

STATES = ("PLAYING", "RUNNING", "PLAYING", "HOLD", "PLAYING", "CALIBRATING", "ARMED", "FAULT", "DISARMED")
"""PLAYING is RUNNING while the drive is not zero."""
MUTE_AFTER = 0.1
"""s, the default of daemon.mute_after."""
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


def recorded(model: Path) -> int:
    """Return how many recordings the calibration of a model has, each of them whole."""
    files = list(raw_folder(model).glob("*.wav"))
    assert all(len(recording.read(file).data) for file in files)
    return len(files)


def break_limit(daemon: KilledDaemon, folder: Path) -> None:
    """Let a run break a limit that is lowered while it goes on; return when that is a fault."""
    told, file = len(daemon.named("fault")), folder / "rig.toml"
    shutil.rmtree(folder / "data" / "runs" / "two", ignore_errors=True)
    daemon.command("begin", run="two", shots=100)
    rig = rig_file.load(file, RigConfig)
    file.write_text(rig_file.dump(rig.model_copy(update={"limits": rig.limits.model_copy(update={"peak": 0.1})})))
    with daemon.client() as client, client.control("Ada", over=True):
        client.reload()
    until(lambda: len(daemon.named("fault")) > told)


def kill_in(daemon: KilledDaemon, folder: Path, state: str, moment: float) -> float:
    """Bring a daemon to a state, wait for a moment, and kill it; return for how long the drive went on, s."""
    with daemon.client() as client:
        assert client.snapshot()["state"]["name"] == "DISARMED"
    assert (folder / "data" / EVENTS).read_text().endswith("\n")  # what the last kill cut short is gone
    run, model = folder / "data" / "runs" / "one", folder / "data" / "calibrated.h5"
    done, records = 0, recorded(model)
    if state != "DISARMED":
        daemon.command("arm")
    if state in ("RUNNING", "PLAYING", "HOLD"):
        daemon.command("begin", run="one", resume=run.exists(), shots=100)
    if state == "CALIBRATING":
        if model.exists():
            model.unlink()
            shutil.rmtree(raw_folder(model))
            records = 0
        daemon.command("begin", "calibrate", model=model.name)
    if state == "HOLD":
        daemon.command("hold")
    if state == "FAULT":
        break_limit(daemon, folder)
    if state in ("PLAYING", "CALIBRATING"):
        until(lambda: model.exists() or (daemon.log.exists() and daemon.drive().any()))
    PATIENCE.wait(moment)
    if run.exists():
        done = daemon.done()
    still = daemon.kill()
    if run.exists():
        whole(run, done)
    assert recorded(model) >= records
    return still


def kills(folder: Path, number: int) -> Iterator[tuple[str, float]]:
    """Kill so many times; yield the state it was in, and for how long the drive went on, s."""
    chance = random.Random(5)
    for count in range(number):
        state = STATES[count % len(STATES)]
        (folder / "log").unlink(missing_ok=True)
        if count % 20 == 19:  # going on with a run takes longer with every shot of it
            (folder / "data" / "runs" / "one").rename(folder / "data" / "runs" / f"one-{count}")
            (folder / "data" / EVENTS).unlink()
        with straight_daemon(folder, MUTE_AFTER) as daemon:
            yield state, kill_in(daemon, folder, state, chance.uniform(0.0, 6.0))
