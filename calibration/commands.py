"""The commands of `calibrate`."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from calibration.comparison_report import comparison_figures, comparison_report
from calibration.experiment import RawFolder, refuse_to_emit
from calibration.far_field_report import HEAD as FAR_FIELD_HEAD
from calibration.far_field_report import far_field_rows
from calibration.from_command import (
    CorrectClockOption,
    DrivesOption,
    ResponsesArgument,
    model_from_files,
    refuse_measuring,
)
from calibration.hysteresis_command import hysteresis_command
from calibration.identification.command import identify_command
from calibration.joint_clamping.command import joints_command
from calibration.milling.command import milling_command
from calibration.milling.velocity_command import velocity_command
from calibration.model_comparison import (
    COMPARED_HEAD,
    DIFFERING_HEAD,
    compare,
    compare_far_fields,
    compared_rows,
    differing_rows,
)
from calibration.multisine_report import level_table
from calibration.output import AgainOption, Output, RecomputeOption, Wish, output
from calibration.stage_axes.command import stage_command
from calibration.sweep_report import sweep_report
from calibration.sweep_summary import BAND_HEAD, WORST_HEAD, band_rows, sweep_figures, worst_rows
from calibration.vibrator import KEPT, KIND, Calibration, LiveLine, calibrate, refuse_unfit, require_room
from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, PngOption, SetOption, application, print_table, words, write_json
from rigkit.stop import Stopped, stoppable
from rigkit.written import made_folder, written_file
from vibractl.config import RigConfig
from vibractl.model_file import read_far_field, read_model, write_model

app = application("Experiments that end in a model file.")
app.command("identify")(identify_command)
app.command("hysteresis")(hysteresis_command)
app.command("joints")(joints_command)
app.command("milling")(milling_command)
app.command("stage")(stage_command)
app.command("velocity")(velocity_command)


@app.command("vibrator")
def vibrator_command(
    out: Annotated[Path, written_file("FILE", "Model file to write; recordings and report go beside it.")],
    config: ConfigOption = None,
    seed: Annotated[int | None, typer.Option(help="Which simulated vibrator.")] = None,
    method: Annotated[str | None, typer.Option(metavar="multisine|stepped|both", help="How it is measured.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Multisine: no line louder than the objective.")] = False,
    passes: Annotated[int | None, typer.Option(help="Stepped sine; 2: once more, on a refined grid.")] = None,
    no_preload: Annotated[bool, typer.Option("--no-preload", help="Leave the preload out, for comparison.")] = False,
    png: PngOption = None,
    drives: DrivesOption = None,
    responses: ResponsesArgument = None,
    correct_clock: CorrectClockOption = False,
    again: AgainOption = False,
    recompute: RecomputeOption = False,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Measure a vibrator's transfer matrix on top of a preload: by a stepped sine, by multisines, or by both.

    Raw recordings are kept in a folder beside the model; stopped or killed, the same command goes on from there.  With
    --from nothing is measured: drives and responses are read from files, whoever recorded them.

    Example: `calibrate vibrator --config rig.toml --out model.h5`; from recordings:
    `calibrate vibrator --from drive.wav heard.wav --out model.h5`
    """
    asked = rig_file.load(config, RigConfig, _laid_over(settings, seed, method, quiet, passes, no_preload))
    if drives or responses:
        measuring = {"--seed": seed, "--method": method, "--quiet": quiet, "--passes": passes}
        refuse_measuring({**measuring, "--no-preload": no_preload, "--recompute": recompute, "--accept": accept})
        clock = {"correct_clock": correct_clock, "again": again}
        model_from_files(out, drives or [], responses or [], asked, inputs=[config], **clock, png=png, json=json)
        return
    if correct_clock:
        raise ValueError("--correct-clock is given without --from, must be with it: one device has one clock")
    wish = Wish(again, recompute, accept or [])
    writes = output(out, KIND, asked, wish, [out.with_suffix(".html")], KEPT, inputs=[config])
    found = _measured(writes, recompute)
    report = sweep_report(found, writes.config)
    report.write(out.with_suffix(".html"))
    if png is not None:
        report.png(png)
    _print(found, out, json)


def _laid_over(
    settings: list[str] | None, seed: int | None, method: str | None, quiet: bool, passes: int | None, no_preload: bool
) -> list[str]:
    """Return the settings that the options stand for."""
    flags = {
        "simulator.options.seed": seed,
        "characterisation.method": "stepped" if passes is not None and method is None else method,
        "characterisation.passes": passes,
        "characterisation.quiet": "true" if quiet else None,
    }
    laid_over = [*(settings or []), *(f"{key}={value}" for key, value in flags.items() if value is not None)]
    if no_preload:
        laid_over += ["characterisation.preload=0.0", "characterisation.operating=0.0"]
    return laid_over


def _measured(writes: Output[RigConfig], recompute: bool) -> Calibration:
    """Measure, or compute again, and write the model."""
    folder = RawFolder(writes.raw)
    if not recompute:
        refuse_unfit(writes.config)
        require_room(writes.config, folder)
    sys.stderr.write("".join(f"{note}\n" for note in writes.notes))
    with writes.begun(), folder as raw:
        found = _calibrated(writes, raw)
        write_model(writes.out, found.matrix.described(seconds=f"{found.seconds:.1f}"), found.far)
        writes.finish()
    return found


@app.command("compare")
def compare_command(
    first: Annotated[Path, typer.Argument(metavar="A.h5")],
    second: Annotated[Path, typer.Argument(metavar="B.h5")],
    out: Annotated[Path | None, written_file("FILE", "Write a report (HTML).")] = None,
    png: Annotated[Path | None, made_folder("DIR", "Write the figures as PNG files.")] = None,
    json: JsonOption = None,
) -> None:
    """Say how two models of one rig differ, line by line, against their uncertainty.

    Example: `calibrate compare tank.h5 sea.h5 --out difference.html`
    """
    names = str(first), str(second)
    found = compare(read_model(first), read_model(second), *names)
    afar = read_far_field(first), read_far_field(second)
    far = None if afar[0] is None or afar[1] is None else compare_far_fields(afar[0], afar[1], *names)
    if out is not None or png is not None:
        report = comparison_report(found, far)
        if out is not None:
            report.write(out)
        if png is not None:
            report.png(png)
    stream = words(json)
    title = f"{found.first_name} and {found.second_name}: {len(found.frequency)} lines in common"
    print_table(title, COMPARED_HEAD, compared_rows(found), stream)
    print_table("farthest apart", DIFFERING_HEAD, differing_rows(found), stream)
    if far is not None:
        print_table("far field", COMPARED_HEAD, compared_rows(far), stream)
    write_json(json, comparison_figures(found, far))


def _calibrated(writes: Output[RigConfig], raw: RawFolder) -> Calibration:
    rig = writes.config
    if writes.is_recomputed:
        return calibrate(rig, raw, refuse_to_emit, writes.provenance)
    with stoppable() as stop, LiveLine(rig, raw, stop) as line:
        try:
            return calibrate(rig, raw, line.emit, writes.provenance)
        except Stopped:
            raise Stopped(writes.left) from None


def _print(found: Calibration, out: Path, json: str | None) -> None:
    stream, figures = words(json), sweep_figures(found)
    title = f"{out}: {figures['lines']} lines from {_duration(found.seconds)} of signal"
    print_table(title, BAND_HEAD, band_rows(found.matrix), stream)
    print_table("least certain", WORST_HEAD, worst_rows(found.matrix), stream)
    if found.levels is not None:
        table = level_table(found.levels)
        print_table("levels of a line; distortion and noise re the multisine's", table.head, table.rows, stream)
    if found.far is not None:
        print_table("far field", FAR_FIELD_HEAD, far_field_rows(found.far), stream)
    if found.loudest is not None:
        print(f"the multisine's loudest line is {found.loudest:.1f} dB re what the preload emits", file=stream)
    if len(found.tones):
        print(f"{len(found.tones)} lines were measured again by a stepped sine", file=stream)
    if len(found.passes) > 1:
        moved, missed = figures["first_pass_median_difference"], figures["first_grid_worst_interpolation"]
        print(f"the first grid misses {100 * missed:.2g} % at worst between its lines", file=stream)
        print(f"from the first pass to the second the lines moved by {100 * moved:.2g} %, median", file=stream)
    print(f"report: {out.with_suffix('.html')}", file=stream)
    write_json(json, figures)


def _duration(seconds: float) -> str:
    return f"{seconds / 60:.1f} min" if seconds >= 120 else f"{seconds:.1f} s"
