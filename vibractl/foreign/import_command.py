"""The command `vibractl import`."""

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, SetOption, laid_over, print_table, words, write_json
from rigkit.progress import progress
from vibractl.config import RigConfig
from vibractl.foreign.import_request import Request, examined
from vibractl.foreign.importing import Import, figures_of, write_import
from vibractl.foreign.recorded import Scales
from vibractl.foreign.tracks import parsed_map
from vibractl.quality import Marks
from vibractl.reference_option import ReferenceOption

HEAD = ("shot", "recording", "begins, s", "correlation", "delay, samples", "clock, ppm", "polarity")

DriveOption = Annotated[str, typer.Option(metavar="D.wav", help="The drive, or a pattern of one file per shot.")]
ResponseOption = Annotated[str, typer.Option(metavar="R.wav", help="The response, or a pattern of one file per shot.")]
OutOption = Annotated[Path | None, typer.Option(metavar="RUN/", help="Folder to make.")]
ModelOption = Annotated[Path | None, typer.Option(metavar="FILE", help="Model file from `calibrate vibrator`.")]
SilenceOption = Annotated[Path | None, typer.Option(metavar="S.wav", help="The same sensors without a drive.")]
MapOption = Annotated[
    str | None, typer.Option("--map", metavar="drive_1=3,...", help="Channels by name or number; - inverts one.")
]
VoltsOption = Annotated[
    float | None, typer.Option("--volts-per-full-scale", help="Full scale of a drive's sound file.")
]
AccelerationOption = Annotated[
    float | None, typer.Option("--mps2-per-full-scale", help="Full scale of a response's sound file, m/s^2.")
]
DelayOption = Annotated[float | None, typer.Option(metavar="SAMPLES", help="Known delay of the responses.")]
ClockOption = Annotated[bool, typer.Option("--correct-clock", help="Correct clock differences and fractional delays.")]
SkipOption = Annotated[
    bool, typer.Option("--skip-spoiled", help="Leave out shots that are clipped, have dropouts or are cut off.")
]
DryOption = Annotated[bool, typer.Option("--dry-run", help="Show the result, and write nothing.")]


def import_command(
    drive: DriveOption,
    response: ResponseOption,
    out: OutOption = None,
    reference: ReferenceOption = None,
    model: ModelOption = None,
    silence: SilenceOption = None,
    config: ConfigOption = None,
    channels: MapOption = None,
    volts: VoltsOption = None,
    acceleration: AccelerationOption = None,
    delay: DelayOption = None,
    correct_clock: ClockOption = False,
    skip_spoiled: SkipOption = False,
    dry_run: DryOption = False,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
    more: Annotated[list[str] | None, typer.Argument(hidden=True)] = None,
) -> None:
    """Make a run folder from recordings of other software: finds the shots, checks and judges them.

    Drive and response are in one file, or in two files with synchronous samples; or the drive of one shot, which is
    located in the response; or patterns, one file of each per shot.

    Example: `vibractl import --drive D.wav --response R.wav --reference chirp:40:90:5 --out RUN/`
    """
    if more:
        raise ValueError(f"{more[0]} is one file too many: quote the pattern, as in --drive 'shots/d*.wav'")
    if (out is None) != dry_run:
        raise ValueError("--out RUN/ says where it goes, --dry-run that it goes nowhere: must be one of them")
    rig = rig_file.load(config, RigConfig, laid_over(settings, {"reference.signal": reference or None}))
    found = examined(
        Request(
            rig, drive, response, model, silence, parsed_map(channels), _scales(rig, volts, acceleration), delay,
            correct_clock, skip_spoiled, accept or [],
        )
    )  # fmt: skip
    _print(found, json)
    figures = {} if out is None else _written(out, found, json)
    shots = [figures_of(shot, found.made) for shot in found.shots]
    write_json(json, {**figures, "found": shots, "remarks": [each.text for each in found.remarks]})


def _scales(rig: RigConfig, volts: float | None, acceleration: float | None) -> Scales:
    """Return what the number 1 of a sound is: as is said, else as the rig file says."""
    for name, value in (("--volts-per-full-scale", volts), ("--mps2-per-full-scale", acceleration)):
        if value is not None and not 0 < value < float("inf"):
            raise ValueError(f"{name} is {value:g}, must be > 0")
    return Scales(volts or rig.audio.output_full_scale, acceleration or rig.audio.input_full_scale)


def _written(out: Path, imported: Import, json: str | None) -> dict[str, Any]:
    """Write the run, and say what came of it."""
    with progress("importing", len(imported.shots)) as meter:

        def tell(shot: int, marks: Marks) -> None:
            meter.show(shot + 1, f"shot {shot}: objective {marks.reason}")

        figures = write_import(out, imported, tell)
    met = figures["objective_met_shot"]
    verdict = f"objective met from shot {met} on" if met is not None else "objective not met"
    words(json).write(f"{out}: {figures['shots']} shots, {verdict}; a report: vibractl report {out}\n")
    return figures


def _print(found: Import, json: str | None) -> None:
    stream, rate, rows = words(json), found.made.shot.rate, []
    for shot in found.shots:
        delay, clock = shot.placed.delay, shot.seen.clock
        rows.append([
            str(shot.number),
            shot.recorded.name,
            f"{(shot.placed.response + shot.placed.fraction) / rate:.6f}",
            f"{shot.seen.likeness:.4f}",
            "-" if delay is None else delay.text,
            "-" if clock is None else clock.text,
            "  ".join(_polarity(sign.is_inverted, sign.confidence) for sign in shot.seen.polarity),
        ])  # fmt: skip
    print_table(f"{len(rows)} shots of {found.made.config.reference.signal}", HEAD, rows, stream)
    for reason in found.left_out.values():
        stream.write(f"left out: {reason}\n")
    for remark in found.remarks:
        stream.write(f"{'warning: ' if remark.is_warning else ''}{remark.text}\n")
    sys.stdout.flush()


def _polarity(is_inverted: bool, confidence: float) -> str:
    """Say a polarity and how sure it is."""
    return f"{'-' if is_inverted else '+'} {100 * confidence:.1f} %" if confidence > 0.5 else "?"
