"""The daemon is killed in mid-run, once and 200 times, in every state: the drive falls silent, and the run goes on."""

from pathlib import Path

import numpy as np
import pytest

from tests.until import until
from tests.vibractl.daemon.killed import straight_daemon
from tests.vibractl.daemon.kills import MUTE_AFTER, kills, whole


@pytest.mark.slow
@pytest.mark.deadline(0.3)
def test_a_daemon_killed_while_it_plays_falls_silent_and_goes_on_where_it_was(tmp_path: Path) -> None:
    with straight_daemon(tmp_path) as daemon:
        daemon.command("arm")
        daemon.command("begin", run="one", shots=100)
        until(lambda: daemon.done() >= 1 and np.abs(daemon.drive()[-2000:]).max() > 0.3)
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
        until(lambda: daemon.named("finished"))
        daemon.kill()
    assert whole(tmp_path / "data" / "runs" / "one", shots + 1) == shots + 1


@pytest.mark.slow
def test_a_daemon_killed_two_hundred_times(tmp_path: Path) -> None:
    played = [seconds for _, seconds in kills(tmp_path, 200) if seconds]
    assert len(played) > 40
    assert max(played) <= MUTE_AFTER
