"""`firmware-sim stage --pty`: the stage in a process of its own, reached through python-can."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from firmware_sim.__main__ import main
from firmware_sim.can_node import mishap
from stagectl.link.config import Link
from stagectl.link.stage_link import StageLink
from stagectl.link.upload import upload
from stagectl.stage.loop_parameters import loop_parameters
from stagectl.wire.messages import State
from tests.contract.source_tree import ROOT
from tests.firmware_sim.test_stage_image import AXES, gentle_loops
from tests.until import EVER

COMMAND = [sys.executable, "-m", "firmware_sim", "stage"]


def test_the_stage_is_there_until_ctrl_c(tmp_path: Path) -> None:
    command = [*COMMAND, "--pty", "--folder", str(tmp_path), "--fault", "garbage@0.1"]
    command += ["--set", "link.silence=10"]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == f"CAN adapter: {tmp_path}/can\n"
        try:
            with StageLink(Link(channel=f"{tmp_path}/can", silence=10.0, patience=20.0)) as link:
                assert link.state is State.HOLDING
                assert link.wait(link.skip() + 5000, EVER)
                upload(link, loop_parameters(AXES, gentle_loops()))
                assert link.counts.lost == 0
        finally:
            process.send_signal(signal.SIGINT)
            assert process.wait(EVER) == 0
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ([], "no wire is chosen, must be --pty"),
        (["--pty", "--fault", "unplug"], "a mishap is unplug, must be NAME@SECONDS"),
        (["--pty", "--fault", "quake@1"], "a mishap is quake@1, must be unplug, replug"),
        (["--pty", "--milling", "w"], "--milling is 'w', must be x, y, z or nothing"),
        (["--pty", "--set", "simulator.options.sed=1"], "unexpected keyword argument 'sed'"),
    ],
)
def test_what_cannot_be_is_one_line_and_leaves_nothing(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    text: str,
) -> None:
    monkeypatch.setattr("sys.argv", ["firmware-sim", "stage", *arguments, "--folder", str(tmp_path / "bench")])
    assert main() == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert text in line
    assert not (tmp_path / "bench").exists()


def test_a_mishap_is_a_name_and_a_time() -> None:
    assert mishap("unplug@2.5").seconds == 2.5
