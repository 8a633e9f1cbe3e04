"""What is installed on a lab PC: systemd understands its units, they let in little, and the commands in them exist."""

import importlib
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import typer

from stagectl.application import PROGRAM as STAGECTL
from tests.contract.source_tree import ROOT
from tests.until import EVER
from vibractl.application import PROGRAM as VIBRACTL

UNITS = sorted((ROOT / "packaging" / "systemd").iterdir())
SERVICES = {
    "vibractl.service": 2.0,
    "stagectl.service": 2.5,
    "vibrostage-prune.service": 1.5,
    "vibrostage-scheduler.service": 1.8,
    "vibrostage-worker.service": 1.8,
}
"""Exposure by `systemd-analyze security`, of 10, at most."""
PROGRAMS = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
ANALYZE = shutil.which("systemd-analyze") or ""

needs_systemd = pytest.mark.skipif(not ANALYZE, reason="no systemd-analyze here (apt-get install systemd)")


@needs_systemd
def test_systemd_understands_every_line(tmp_path: Path) -> None:
    """It reads over what it does not know, and says so."""
    for unit in UNITS:
        text = re.sub(r"/opt/vibrostage/\.venv/bin/\w+", "/bin/true", unit.read_text())  # which are not there
        (tmp_path / unit.name).write_text(re.sub(r"(User|Group)=vibrostage", r"\1=root", text))
    command = [ANALYZE, "verify", "--man=no", *map(str, tmp_path.iterdir())]
    done = subprocess.run(command, capture_output=True, text=True, timeout=EVER, check=False)
    assert (done.returncode, done.stdout + done.stderr) == (0, "")


@needs_systemd
@pytest.mark.parametrize("name", SERVICES)
def test_a_service_is_exposed_to_little(name: str) -> None:
    file = ROOT / "packaging" / "systemd" / name
    command = [ANALYZE, "security", "--offline=true", "--no-pager", f"--threshold={10 * SERVICES[name]:.0f}", str(file)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=EVER, check=False)
    assert "Overall exposure level" in done.stdout
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("command", ["daemon", "prune"])
@pytest.mark.parametrize(("program", "app"), [("vibractl", VIBRACTL.only()), ("stagectl", STAGECTL.only())])
def test_what_the_units_call_exists(program: str, app: typer.Typer, command: str) -> None:
    calls = [
        shlex.split(line.partition("=")[2])
        for unit in UNITS
        for line in unit.read_text().splitlines()
        if line.startswith("ExecStart=") and f"{program} {command}" in line
    ]
    assert calls
    known = typer.main.get_command(app).commands[command]  # type: ignore[attr-defined]
    options = {name for each in known.params for name in each.opts}
    for call in calls:
        assert {word for word in call if word.startswith("--")} <= options


@pytest.mark.parametrize("program", ["scheduler", "worker"])
def test_what_the_cluster_units_call_takes_their_options(program: str) -> None:
    command_line = pytest.importorskip(f"distributed.cli.dask_{program}", reason="distributed is not installed")
    text = (ROOT / "packaging" / "systemd" / f"vibrostage-{program}.service").read_text()
    (call,) = re.findall(rf"^ExecStart=.*/dask {program} (.*)$", text, re.MULTILINE)
    known = {name for each in command_line.main.params for name in (*each.opts, *each.secondary_opts)}
    assert {word for word in call.split() if word.startswith("--")} <= known


def test_the_limits_and_rules_are_of_a_form_that_their_readers_take() -> None:
    """pam_limits: four words a line; udev: pairs of key, operator and quoted value."""
    limits = (ROOT / "packaging/limits.d/95-vibrostage.conf").read_text().splitlines()
    assert all(len(line.split()) == 4 for line in limits if line and not line.startswith("#"))
    pair = r'[A-Z]+(\{[\w./]+\})?(==|!=|\+=|=)"[^"]*"'
    rules = (ROOT / "packaging/udev/60-vibrostage.rules").read_text().splitlines()
    for rule in (line for line in rules if line and not line.startswith("#")):
        assert re.fullmatch(rf"{pair}(, {pair})*", rule), rule


@pytest.mark.parametrize(("program", "place"), PROGRAMS.items())
def test_every_program_says_its_version_and_python_m_is_the_same_program(
    program: str, place: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    module, _, main = place.partition(":")
    assert module.endswith(".__main__")
    monkeypatch.setattr(sys, "argv", [program, "--version"])
    assert getattr(importlib.import_module(module), main)() == 0
    assert re.fullmatch(r"vibrostage \d+\.\d+(\.\w+)*( \([0-9a-f]{12}\+?\))?, Python [\d.]+\n", capsys.readouterr().out)
