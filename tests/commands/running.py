"""A page's command, run in this process or as a stranger's shell does."""

import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from calibration.__main__ import main as calibrate
from firmware_sim.__main__ import main as firmware_sim
from stagectl.__main__ import main as stagectl
from tests.commands.page_commands import TOOLS, Command
from vibractl.__main__ import main as vibractl
from vibrostage.__main__ import main as vibrostage

MAINS = {
    "vibractl": vibractl,
    "stagectl": stagectl,
    "calibrate": calibrate,
    "firmware-sim": firmware_sim,
    "vibrostage": vibrostage,
}
"""What each program's name calls, with its command line in `sys.argv`."""
HOUR = 3_600.0


def run_here(
    command: Command, appended: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Run a command with more words in this process and folder, and see that it ends well."""
    words = [*command.words, *shlex.split(appended)]
    monkeypatch.setattr(sys, "argv", words)
    status = MAINS[words[0]]()
    printed = capsys.readouterr()
    assert status == 0, f"{shlex.join(words)}: {printed.err[-2_000:]}"
    if command.into:
        Path(command.into).write_text(printed.out)


def run(command: Command, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command in a folder to its end, as printed; its output goes where it says."""
    name = command.words[0]
    program = name if name in TOOLS else str(Path(sys.executable).parent / name)
    words = [program, *command.words[1:]]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=HOUR, check=False)
    if command.into:
        (folder / command.into).write_text(done.stdout)
    return done
