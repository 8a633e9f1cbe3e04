"""The command `vibractl doctor`."""

from pathlib import Path
from typing import Annotated

import typer

from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, SetOption, print_table, words, write_json
from rigkit.issue_file import SUFFIX, write_issue_file
from rigkit.progress import progress
from rigkit.stop import Stopped
from rigkit.verdict import advice
from rigkit.written import written_file
from vibractl.config import RigConfig
from vibractl.doctor.examination import Examination, announcement, duration, examine
from vibractl.doctor.report import write_report
from vibractl.model_origin import model_for

DEVICES = "sounddevice:query_devices"
"""What lists the sound devices."""
ReportOption = Annotated[
    Path | None,
    written_file(
        "FILE", ".html: a page with figures; .zip: an archive for a request for help, without names.", "--report"
    ),
]


def doctor_command(
    config: ConfigOption = None,
    model: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Model file to compare the rig with, channel by channel.")
    ] = None,
    accept: AcceptOption = None,
    report: Annotated[
        Path | None,
        written_file("FILE", ".html: a page with figures; .zip: an archive for a request for help, without names."),
    ] = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Check a rig before it is used: card, cables, clock, hum, noise, distortion, channels, polarity.

    Plays small signals for half a minute, within the limits of the rig file.  Ctrl-C ramps down and ends.  The exit
    status is 1 if a verdict fails.

    Example: `vibractl doctor --config rig.toml --report doctor.html`
    """
    if report is not None and report.suffix.lower() not in (".html", SUFFIX):
        raise ValueError(f"--report is {report}, must end in .html or {SUFFIX}")
    made = rig_file.load(config, RigConfig, settings or ())
    matrix, notes = (None, []) if model is None else model_for(model, made, accept or ())
    stream, total = words(json), duration(made)
    stream.write("".join(f"{note}\n" for note in notes))
    stream.write(f"Plays for {total:.0f} s:\n" + "".join(f"  {line}\n" for line in announcement(made)))
    stream.flush()
    try:
        with progress("doctor", total) as meter:
            found = examine(made, meter.show, matrix)
            meter.show(total)
    except KeyboardInterrupt:
        raise Stopped("stopped; every output is ramped down to zero") from None
    _print(found, json)
    if report is not None and report.suffix.lower() == SUFFIX:
        lines = write_issue_file(report, {"rig.toml": made}, found.verdicts, DEVICES)
        stream.write(f"{report} holds:\n" + "".join(f"  {line}\n" for line in lines))
    elif report is not None:
        write_report(report, found)
    verdict = "fail" if found.failed else "pass"
    checks = [each.figures() for each in found.verdicts]
    write_json(json, {"rig": made.rig.name, "verdict": verdict, "seconds": total, "checks": checks})
    if found.failed:
        raise typer.Exit(1)


def _print(found: Examination, json: str | None) -> None:
    rows = [[each.check, each.grade, each.measured, each.limit] for each in found.verdicts]
    print_table(
        f"{found.config.rig.name}: verdicts of the doctor",
        ["check", "verdict", "measured", "wanted"],
        rows,
        words(json),
    )
    words(json).write("".join(f"{line}\n" for line in advice(found.verdicts)))
