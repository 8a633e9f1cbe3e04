"""The command `vibractl predict`."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, SetOption, laid_over, print_table, words, write_json
from rigkit.common_options import one_of
from rigkit.progress import progress
from rigkit.written import written_file
from vibractl.config import RigConfig
from vibractl.learning.kinds_of_law import KINDS
from vibractl.model_file import read_far_field
from vibractl.model_origin import model_for
from vibractl.predict.prediction import RUNS, Prediction, predict
from vibractl.predict.report import drive_table, reason_table, shots_text, write_report
from vibractl.reference_option import ReferenceOption
from vibractl.setup import setup


def predict_command(
    model: Annotated[Path, typer.Option(metavar="FILE", help="Model file from `calibrate vibrator`.")],
    config: ConfigOption = None,
    reference: ReferenceOption = None,
    shots: Annotated[int | None, typer.Option(help="Shots of each simulated run.")] = None,
    side: Annotated[int | None, typer.Option(help="Drive and control this side only; 0 for all.")] = None,
    law: Annotated[
        str | None, typer.Option(help=f"Law of learning: {', '.join(KINDS)}.", autocompletion=one_of(KINDS))
    ] = None,
    report: Annotated[Path | None, written_file("FILE", "Write an HTML page with figures.")] = None,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Predict what a run needs and how it converges, before anything is emitted.

    Drives and headroom, frequency bins without a convergence certificate and why, and the shots to the objective.

    Example: `vibractl predict --model model.h5 --reference chirp:40:90:5 --report predicted.html`
    """
    flags = {
        "reference.signal": reference,
        "session.shots": shots,
        "learning.side": side,
        "learning.law": law,
    }
    made_with = rig_file.load(config, RigConfig, laid_over(settings, flags))
    matrix, notes = model_for(model, made_with, accept or [])
    made = setup(made_with, matrix, far=read_far_field(model, len(made_with.audio.far_field_channels)))
    sys.stderr.write("".join(f"{note}\n" for note in notes))
    with progress("predicting", RUNS) as meter:
        found = predict(made, RUNS, meter.show)
    _print(found, json)
    if report is not None:
        write_report(report, found)
    write_json(json, found.figures())


def _print(found: Prediction, json: str | None) -> None:
    stream, config = words(json), found.made.config
    drives, reasons = drive_table(found), reason_table(found)
    print_table(f"{config.rig.name}, {config.reference.signal}: drives", drives.head, drives.rows, stream)
    if found.drives.violation:
        stream.write(f"the guard would not let it out: {found.drives.violation}\n")
    if found.made.note:
        stream.write(f"{found.made.note}\n")
    certified = f"{found.lines.certified.sum()} of {found.lines.learned.sum()} learned bins are certified to converge"
    if reasons.rows:
        print_table(certified, reasons.head, reasons.rows, stream)
    else:
        stream.write(f"{certified}\n")
    stream.write(f"law {config.learning.law}, objective {config.quality.objective:g} dB: {shots_text(found)}\n")
