"""The command `stagectl doctor`."""

from pathlib import Path
from typing import Annotated

import typer

from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, print_table, words, write_json
from rigkit.issue_file import SUFFIX, write_issue_file
from rigkit.progress import progress
from rigkit.verdict import advice
from rigkit.written import written_file
from stagectl.config import StageConfig
from stagectl.doctor.examination import examined
from stagectl.doctor.wake_up import is_real_time_granted, wake_ups
from stagectl.robot.config import CellConfig

PERIOD = 1e-3
"""s between two moments that are waited for: the stage's frames."""

DEVICES = "serial.tools.list_ports:comports"
"""What lists the serial ports."""
ReportOption = Annotated[
    Path | None, written_file("FILE.zip", "An archive for a request for help, without names.", "--report")
]


def doctor_command(
    config: ConfigOption = None,
    stage: Annotated[Path | None, typer.Option(metavar="FILE", help="Rig file of the stage.")] = None,
    seconds: Annotated[float, typer.Option(help="Duration; run the usual other programs meanwhile.")] = 10.0,
    report: ReportOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Measure the wake-up latency of this computer against the silence that robot and stage allow.

    Nothing is opened, and nothing moves.  `--config` and `--set` are of the cell's file.  The exit status is 1 if a
    verdict fails.

    Example: `stagectl doctor --config cell.toml --stage stage.toml`
    """
    if not 0.5 <= seconds <= 3600.0:
        raise ValueError(f"--seconds is {seconds:g}, must be 0.5 to 3600")
    if report is not None and report.suffix.lower() != SUFFIX:
        raise ValueError(f"--report is {report}, must end in {SUFFIX}")
    cell = rig_file.load(config, CellConfig, settings or [])
    its_stage = rig_file.load(stage, StageConfig, [])
    with progress("measuring wake-ups", seconds) as meter:
        seen = wake_ups(PERIOD, seconds, meter.show)
    found = examined(seen, cell, its_stage, is_real_time_granted())
    rows = [[each.check, each.grade, each.measured, each.limit] for each in found]
    print_table(f"wake-up latency, {seconds:g} s", ["check", "verdict", "measured", "limit"], rows, words(json))
    words(json).write("".join(f"{line}\n" for line in advice(found)))
    if report is not None:
        lines = write_issue_file(report, {"cell.toml": cell, "stage.toml": its_stage}, found, DEVICES)
        words(json).write(f"{report} holds:\n" + "".join(f"  {line}\n" for line in lines))
    failed = any(each.grade == "fail" for each in found)
    write_json(
        json,
        {"verdict": "fail" if failed else "pass", "seconds": seconds, "checks": [each.figures() for each in found]},
    )
    if failed:
        raise typer.Exit(1)
