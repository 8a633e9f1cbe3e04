"""The command `vibractl import`."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from ctlblocks.recording import RecordingError
from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, SetOption, print_table, words, write_json
from rigkit.foreign_stream import Signals
from rigkit.progress import progress
from vibractl.config import RigConfig
from vibractl.foreign.import_plan import Scanned, scan
from vibractl.foreign.import_verdict import Remark, refuse_other_clock, refuse_unrelated, remarks, spoiled
from vibractl.foreign.importing import Import, correction_of, figures_of, write_import
from vibractl.foreign.recorded import Scales, open_recorded, paired
from vibractl.foreign.signals import Kind, responses_of
from vibractl.foreign.tracks import open_track, parsed_map
from vibractl.judging import Judging
from vibractl.model_origin import model_for
from vibractl.quality import Marks
from vibractl.setup import Setup, setup
from vibractl.transfer_matrix import TransferMatrix

HEAD = ("shot", "recording", "begins, s", "correlation", "delay, samples", "clock, ppm", "polarity")


def import_command(
    drive: Annotated[str, typer.Option(metavar="D.wav", help="What was played, or a pattern: a file a shot.")],
    response: Annotated[str, typer.Option(metavar="R.wav", help="What was recorded, or a pattern: a file a shot.")],
    out: Annotated[Path | None, typer.Option(metavar="RUN/", help="Folder to make.")] = None,
    reference: Annotated[
        str | None, typer.Option(help="chirp:F0:F1:SECONDS, sine:F0:SECONDS, or a WAV or CSV file.")
    ] = None,
    model: Annotated[Path | None, typer.Option(metavar="FILE", help="Model file from `calibrate vibrator`.")] = None,
    silence: Annotated[Path | None, typer.Option(metavar="S.wav", help="The same sensors without a drive.")] = None,
    config: ConfigOption = None,
    channels: Annotated[
        str | None, typer.Option("--map", metavar="drive_1=3,...", help="Channels by name or number; - turns round.")
    ] = None,
    volts: Annotated[float | None, typer.Option("--volts-per-full-scale", help="Of a sound of drives.")] = None,
    acceleration: Annotated[
        float | None, typer.Option("--mps2-per-full-scale", help="Of a sound of responses, m/s^2.")
    ] = None,
    delay: Annotated[
        float | None, typer.Option(metavar="SAMPLES", help="By which responses come late, where that is known.")
    ] = None,
    correct_clock: Annotated[
        bool, typer.Option("--correct-clock", help="Take out how clocks differ, and parts of a sample.")
    ] = False,
    skip_spoiled: Annotated[
        bool, typer.Option("--skip-spoiled", help="Leave out shots that are clipped, have dropouts or are cut off.")
    ] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Show what is found, and write nothing.")] = False,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
    more: Annotated[list[str] | None, typer.Argument(hidden=True)] = None,
) -> None:
    """Make the folder of a run from recordings of other software: found, checked, judged.

    Drive and response are one file that holds both, or two, sample by sample beside each other; or the drive of one
    shot, which is found wherever in the response it was played; or patterns, a file of each a shot.

    Example: `vibractl import --drive D.wav --response R.wav --reference chirp:40:90:5 --out RUN/`
    """
    if more:
        raise ValueError(f"{more[0]} is one file too many: a pattern stands in quotes, as in --drive 'shots/d*.wav'")
    if (out is None) != dry_run:
        raise ValueError("--out RUN/ says where it goes, --dry-run that it goes nowhere: must be one of them")
    laid_over = [*(settings or []), *([f"reference.signal={reference}"] if reference else [])]
    rig = rig_file.load(config, RigConfig, laid_over)
    made, matrix, notes = _made(rig, model, accept or [])
    scales = Scales(
        rig.audio.output_full_scale if volts is None else _positive("--volts-per-full-scale", volts),
        rig.audio.input_full_scale if acceleration is None else _positive("--mps2-per-full-scale", acceleration),
    )
    given = parsed_map(channels)
    quiet = None if silence is None else _silence(silence, made, scales, given)
    recordings = [open_recorded(*pair, rig, made.shot, scales, given) for pair in paired(drive, response)]
    with progress("examining", len(recordings)) as meter:
        scanned = scan(recordings, made, matrix, delay, meter.show)
    refuse_unrelated(scanned, made)
    if not correct_clock:
        refuse_other_clock(scanned, made)
    scanned, left_out = _whole(scanned, made, skip_spoiled)
    said = [Remark(note) for note in notes] + list(remarks(scanned, made))
    if correct_clock:
        said = [*(each for each in said if "--correct-clock" not in each.text), *_corrections(scanned)]
    _print(scanned, made, said, left_out, json)
    found = [figures_of(shot, made) for each in scanned for shot in each.shots]
    figures: dict[str, Any] = {"found": found, "remarks": [each.text for each in said]}
    if out is not None:
        imported = Import(scanned, made, model, said, left_out, quiet, accept or [], correct_clock)
        figures = {**_written(out, imported, json), **figures}
    write_json(json, figures)


def _made(
    rig: RigConfig, model: Path | None, accept: list[str]
) -> tuple[Setup | Judging, TransferMatrix | None, list[str]]:
    """Return what shots are judged by, and the model."""
    if rig.audio.far_field_channels:
        raise ValueError(
            f"audio.far_field_channels is {list(rig.audio.far_field_channels)}, must be []: drives and accelerometers "
            "are imported, no hydrophones; --set audio.far_field_channels=[]"
        )
    if model is None:
        return Judging.of(rig), None, []
    matrix, notes = model_for(model, rig, accept)
    return setup(rig, matrix), matrix, notes


def _positive(name: str, value: float) -> float:
    if not 0 < value < np.inf:
        raise ValueError(f"{name} is {value:g}, must be > 0")
    return value


def _silence(path: Path, made: Setup | Judging, scales: Scales, given: Mapping[str, str]) -> Signals:
    audio = made.config.audio
    kind = Kind("response", responses_of(audio).width, "m/s^2", scales.acceleration)
    track = open_track(path, [kind], audio.rate, given)
    if track.frames < made.shot.total:
        raise RecordingError(f"{path}: {track.frames} samples, must be at least {made.shot.total}, a shot's")
    return track.signals.scaled(kind.unit, track.scale)


def _whole(scanned: Sequence[Scanned], made: Setup | Judging, skip: bool) -> tuple[list[Scanned], dict[int, str]]:
    """Return recordings with the shots that are a measurement, and why others are left out."""
    wrong = {number: reason for each in scanned for number, reason in spoiled(each, made).items()}
    if wrong and not skip:
        first = next(iter(wrong.values()))
        raise RecordingError(f"{first}; --skip-spoiled leaves out such shots, {len(wrong)} of them")
    kept = [replace(each, shots=tuple(shot for shot in each.shots if shot.number not in wrong)) for each in scanned]
    kept = [each for each in kept if each.shots]
    if not kept:
        raise RecordingError(f"{next(iter(wrong.values()))}; no shot is left, must be at least 1")
    return kept, wrong


def _corrections(scanned: Sequence[Scanned]) -> list[Remark]:
    """Say what is taken out of the clocks."""
    said = []
    for each in scanned:
        taken = correction_of(each)
        what = f"{taken.text} ppm" if taken.value else "nothing that can be told"
        said.append(Remark(f"{each.recorded.name}: taken out of the clock: {what}; responses are resampled"))
    return said


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


def _print(
    scanned: Sequence[Scanned],
    made: Setup | Judging,
    said: Sequence[Remark],
    left_out: Mapping[int, str],
    json: str | None,
) -> None:
    stream = words(json)
    rows = []
    for each in scanned:
        for shot in each.shots:
            delay, clock = shot.placed.delay, shot.seen.clock
            begins = (shot.placed.response + shot.placed.fraction) / made.shot.rate
            rows.append([
                str(shot.number), each.recorded.name, f"{begins:.6f}", f"{shot.seen.likeness:.4f}",
                "-" if delay is None else delay.text,
                "-" if clock is None else clock.text,
                "  ".join(_polarity(sign.is_inverted, sign.confidence) for sign in shot.seen.polarity),
            ])  # fmt: skip
    print_table(f"{len(rows)} shots of {made.config.reference.signal}", HEAD, rows, stream)
    for reason in left_out.values():
        stream.write(f"left out: {reason}\n")
    for remark in said:
        stream.write(f"{'warning: ' if remark.is_warning else ''}{remark.text}\n")
    sys.stdout.flush()


def _polarity(is_inverted: bool, confidence: float) -> str:
    """Say a polarity and how sure it is."""
    return f"{'-' if is_inverted else '+'} {100 * confidence:.1f} %" if confidence > 0.5 else "?"
