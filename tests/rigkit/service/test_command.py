"""`status` and `stop` at the shell, against a daemon that runs."""

import json
import os
import signal
import socket
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from pydantic import Field

from rigkit.command import application, run
from rigkit.config import Section
from rigkit.service.command import status_command, stop_command
from rigkit.service.config import Daemon
from rigkit.service.daemon import Service
from rigkit.service.daemon_command import Kind, daemon_of
from rigkit.service.stopping import LOCK
from tests.rigkit.service.demo_rig import DemoRig
from tests.rigkit.service.served import ROOT, Served, free_port, served
from tests.until import until


class Rig(Section):
    """A rig file."""

    daemon: Daemon = Field(default_factory=Daemon)


PROGRAM = application("A demonstration.")
PROGRAM.command("daemon")(daemon_of(lambda *_: Kind(Rig, "tests.rigkit.service.demo_rig:anew")))
PROGRAM.command("status")(status_command)
PROGRAM.command("stop")(stop_command)


class Shell:
    """A shell at which the program is called, in this process: half a second less than in one of its own."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
        self.monkeypatch = monkeypatch
        self.capsys = capsys

    def __call__(self, folder: Path, *arguments: str) -> tuple[int, str, str]:
        """Call a command in a folder; return status, standard output and standard error."""
        self.capsys.readouterr()
        with self.monkeypatch.context() as here:
            here.chdir(folder)
            here.setattr(sys, "argv", ["program", *arguments])
            status = run(PROGRAM)
        return status, *self.capsys.readouterr()

    def of(self, daemon: Served, *arguments: str) -> tuple[int, str, str]:
        """Call a command with a daemon's address and data folder as settings."""
        settings = (f"--set=daemon.{name}={getattr(daemon.settings, name)}" for name in ("address", "data"))
        return self(ROOT, *arguments, *settings)


@pytest.fixture
def shell(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Shell:
    return Shell(monkeypatch, capsys)


@pytest.fixture(scope="module")
def daemon(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with served(tmp_path_factory.mktemp("lab"), lease=2.0) as made:
        yield made


def test_the_status_is_told_to_people_and_programs(daemon: Served, tmp_path: Path, shell: Shell) -> None:
    status, out, _ = shell.of(daemon, "status", "--json", str(tmp_path / "status.json"))
    assert status == 0
    assert "DISARMED" in out
    assert "<= 1.05e-06" in out
    assert json.loads((tmp_path / "status.json").read_text())["rig"] == "bench"


def test_a_stop_at_the_shell_says_what_it_has_stopped(daemon: Served, shell: Shell) -> None:
    daemon.begin(steps=100_000, seconds=0.02)
    assert shell.of(daemon, "stop", "--why", "smoke")[:2] == (0, "stopped: RUNNING -> DISARMED\n")
    until(lambda: [each["why"] for each in daemon.named("stop")] == ["smoke"])


def test_a_reason_that_is_no_text_is_told_as_far_as_it_is(daemon: Served, shell: Shell) -> None:
    until(lambda: not daemon.named("run") or daemon.named("end"))
    assert shell.of(daemon, "stop", "--why", os.fsdecode(b"smok\xff"))[:2] == (0, "stopped: DISARMED -> DISARMED\n")
    until(lambda: daemon.named("stop")[-1]["why"] == "smok?")


def test_who_has_the_token_to_view_alone_looks_and_stops_at_the_shell(
    daemon: Served, tmp_path: Path, shell: Shell
) -> None:
    until(lambda: not daemon.named("run") or daemon.named("end"))
    daemon.begin(steps=100_000, seconds=0.02)
    (tmp_path / "view").write_text(f"{daemon.tokens.view}\n")
    assert "RUNNING" in shell.of(daemon, "status", "--token", str(tmp_path / "view"))[1]
    stop = shell.of(daemon, "stop", "--token", str(tmp_path / "view"), "--why", "smoke from afar")
    assert stop[:2] == (0, "stopped: RUNNING -> DISARMED\n")
    until(lambda: daemon.named("stop")[-1]["why"] == "smoke from afar")
    (tmp_path / "view").write_text("x" * 43)
    assert shell.of(daemon, "status", "--token", str(tmp_path / "view"))[2] == "error: the token is not this daemon's\n"
    status, _, error = shell.of(daemon, "status", "--token", str(tmp_path / "none"))
    assert (status, error.count("\n")) == (2, 1)
    assert "none" in error


def test_a_stop_at_the_shell_reaches_a_daemon_whose_page_does_not_answer(daemon: Served, shell: Shell) -> None:
    until(lambda: daemon.named("end"))
    daemon.begin(steps=100_000, seconds=0.02)
    stops = len(daemon.named("stop"))
    web = daemon.web
    os.kill(web, signal.SIGKILL)
    status, out, _ = shell.of(daemon, "stop")
    assert status == 0
    assert f"process {daemon.process.pid}, which works in" in out or "stopped: RUNNING" in out
    until(lambda: len(daemon.named("stop")) > stops)


@pytest.mark.slow
def test_where_no_daemon_runs_that_is_said_in_one_line(tmp_path: Path, shell: Shell) -> None:
    with served(tmp_path) as gone:
        pass
    assert gone.process.returncode == 0
    for command in ("stop", "status"):
        status, _, error = shell.of(gone, command)
        assert status == 2
        assert error.count("\n") == 1
        assert "no daemon works in" in error or "no answer from the daemon" in error
    assert (tmp_path / LOCK).exists()


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Served, Path]]:
    """Return a daemon whose rig file names its data folder relative to itself, and where that file belongs."""
    rig = tmp_path_factory.mktemp("labs") / "d1" / "rig.toml"
    rig.parent.mkdir()
    with served(rig.parent / "data", file=rig) as made:
        yield made, rig


@pytest.fixture
def lab(kept: tuple[Served, Path]) -> tuple[Served, Path]:
    """Return that daemon at rest, and its rig file as it was."""
    made, rig = kept
    rig.write_text(f'[daemon]\ndata = "data"\naddress = "{made.settings.address}"\n')
    until(lambda: len(made.named("run")) == len(made.named("end")))
    return made, rig


@pytest.mark.slow
def test_a_stop_works_from_any_folder_with_the_rig_file(lab: tuple[Served, Path], shell: Shell) -> None:
    made, rig = lab
    for place, named in ((rig.parents[1], "d1/rig.toml"), (rig.parent, "rig.toml"), (Path("/"), str(rig))):
        made.begin(steps=100_000, seconds=0.02)
        assert shell(place, "stop", "--config", named) == (0, "stopped: RUNNING -> DISARMED\n", "")
        until(lambda: len(made.named("run")) == len(made.named("end")))
    assert shell(rig.parents[1], "status", "--config", "d1/rig.toml")[0] == 0
    assert sorted(each.name for each in rig.parents[1].iterdir()) == ["d1"]


@pytest.mark.parametrize("edit", ["[audio]\nrate = 3\n", "[daemon]\nhosts = 3\n", "[daemon\n", None])
def test_a_stop_gets_through_whatever_the_rig_file_was_edited_to(
    edit: str | None, lab: tuple[Served, Path], shell: Shell
) -> None:
    made, rig = lab
    stops = len(made.named("stop"))
    made.begin(steps=100_000, seconds=0.02)
    if edit is None:
        rig.unlink()
    else:
        rig.write_text(edit if edit.startswith("[daemon") else rig.read_text() + edit)
    status, out, _ = shell(rig.parents[1], "stop", "--config", "d1/rig.toml")
    assert status == 0
    if edit is None or edit.startswith("[daemon"):
        assert f"process {made.process.pid}, which was started with d1/rig.toml, was stopped by a signal" in out
    else:
        assert out == "stopped: RUNNING -> DISARMED\n"
        assert shell(rig.parents[1], "status", "--config", "d1/rig.toml")[0] == 0
    until(lambda: len(made.named("stop")) > stops)


def test_where_the_rig_file_is_wrong_and_no_daemon_has_it_both_are_said(tmp_path: Path, shell: Shell) -> None:
    (tmp_path / "rig.toml").write_text("[daemon\n")
    status, _, error = shell(tmp_path, "stop", "--config", "rig.toml")
    assert (status, error.count("\n")) == (2, 1)
    assert "nothing was stopped: by its page: rig.toml: not TOML" in error
    assert "by a signal: no daemon was started with rig.toml" in error


def test_a_second_daemon_of_a_rig_file_with_an_address_of_its_own_may_run(
    lab: tuple[Served, Path], tmp_path: Path
) -> None:
    made, rig = lab
    table = made.settings.model_copy(update={"data": str(tmp_path / "other"), "address": f"127.0.0.1:{free_port()}"})
    with Service(DemoRig(), table, rig):
        pass


def test_a_stop_without_the_rig_file_goes_by_the_address(
    lab: tuple[Served, Path], tmp_path: Path, shell: Shell
) -> None:
    made, _ = lab
    stops = len(made.named("stop"))
    made.begin(steps=100_000, seconds=0.02)
    address = f"--set=daemon.address={made.settings.address}"
    status, out, _ = shell(tmp_path, "stop", address)
    assert status == 0
    assert f"process {made.process.pid}, which has the address {made.settings.address}, was stopped by a signal" in out
    assert "data/tokens.toml" in out or "data/" in out
    until(lambda: len(made.named("stop")) > stops)
    status, _, error = shell(tmp_path, "status", address)
    assert (status, error.count("\n")) == (2, 1)
    assert f"something answers at {made.settings.address}" in error


def test_where_something_answers_it_is_never_said_that_no_daemon_runs(tmp_path: Path, shell: Shell) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        address = f"127.0.0.1:{other.getsockname()[1]}"
        status, _, error = shell(tmp_path, "stop", f"--set=daemon.address={address}")
    assert (status, error.count("\n")) == (2, 1)
    assert f"nothing was stopped at {address}; something answers there, though: by its page: " in error
    assert "by a signal: no daemon works in data/; by a signal: no daemon has the address" in error


def test_a_second_daemon_at_an_address_is_told_who_has_it(lab: tuple[Served, Path], tmp_path: Path) -> None:
    made, _ = lab
    table = made.settings.model_copy(update={"data": str(tmp_path / "other")})
    with pytest.raises(OSError, match=rf"daemon at port \d+ is in use by process {made.process.pid} "):
        Service(DemoRig(), table)


@pytest.mark.slow
def test_control_that_is_watched_with_lasts(daemon: Served) -> None:
    """The lease is 2 s."""
    with daemon.client() as client, client.control("Ada", over=True):
        ticks = [shown["tick"] for shown, _ in zip(client.watch(), range(80), strict=False)]
        assert ticks[-1] - ticks[0] >= 79
        assert client.ask("PUT", "/api/control")["who"] == "Ada"


@pytest.mark.slow
def test_a_hangup_reloads_the_rig_file(daemon: Served) -> None:
    daemon.process.send_signal(signal.SIGHUP)
    until(lambda: daemon.named("reload"))
    until(lambda: daemon.newest("reload", "who") == "signal")
