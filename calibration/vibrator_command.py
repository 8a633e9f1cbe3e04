"""`calibrate vibrator`."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from calibration.experiment import RawFolder, refuse_to_emit
from calibration.far_field_report import HEAD as FAR_FIELD_HEAD
from calibration.far_field_report import far_field_rows
from calibration.from_command import (
    CorrectClockOption,
    DrivesOption,
    MapOption,
    ResponsesArgument,
    model_from_files,
    refuse_measuring,
    refuse_without_files,
)
from calibration.multisine_report import level_table
from calibration.output import AgainOption, Output, RecomputeOption, Wish, output
from calibration.sweep_report import sweep_report
from calibration.sweep_summary import BAND_HEAD, WORST_HEAD, band_rows, sweep_figures, worst_rows
from calibration.vibrator import KEPT, KIND, Calibration, LiveLine, calibrate, refuse_unfit, require_room
from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, PngOption, SetOption, laid_over, print_table, words, write_json
from rigkit.stop import Stopped, stoppable
from rigkit.written import written_file
from vibractl.config import RigConfig
from vibractl.model_file import write_model


def vibrator_command(
    out: Annotated[Path, written_file("FILE", "Model file to write; recordings and report go beside it.")],
    config: ConfigOption = None,
    seed: Annotated[int | None, typer.Option(help="Seed of the simulated vibrator.")] = None,
    method: Annotated[str | None, typer.Option(metavar="multisine|stepped|both", help="How it is measured.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Multisine: no bin louder than the objective.")] = False,
    around: Annotated[
        str | None, typer.Option(metavar="band|reference", help="Multisine: origin of its preload.")
    ] = None,
    passes: Annotated[int | None, typer.Option(help="Stepped sine; 2: once more, on a refined grid.")] = None,
    no_preload: Annotated[bool, typer.Option("--no-preload", help="Leave the preload out, for comparison.")] = False,
    png: PngOption = None,
    drives: DrivesOption = None,
    responses: ResponsesArgument = None,
    channels: MapOption = None,
    correct_clock: CorrectClockOption = False,
    again: AgainOption = False,
    recompute: RecomputeOption = False,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Measure a vibrator's transfer matrix on top of a preload: by a stepped sine, by multisines, or by both.

    Raw recordings are stored in a folder beside the model; after a stop or kill the same command continues there.  With
    --from nothing is measured: drives and responses are read from files of any origin.

    Example: `calibrate vibrator --config rig.toml --out model.h5`; from recordings:
    `calibrate vibrator --from drive.wav heard.wav --out model.h5`
    """
    flags = {"simulator.options.seed": seed, "characterisation.quiet": quiet, "characterisation.around": around}
    asked = rig_file.load(config, RigConfig, laid_over(settings, {**flags, **_method(method, passes, no_preload)}))
    if drives or responses:
        measuring = {"--seed": seed, "--method": method, "--quiet": quiet, "--around": around, "--passes": passes}
        refuse_measuring({**measuring, "--no-preload": no_preload, "--recompute": recompute, "--accept": accept})
        clock = {"correct_clock": correct_clock, "again": again}
        model_from_files(out, drives or [], responses or [], channels, asked, [config], **clock, png=png, json=json)
        return
    refuse_without_files(correct_clock, channels)
    wish = Wish(again, recompute, accept or [])
    writes = output(out, KIND, asked, wish, [out.with_suffix(".html")], KEPT, inputs=[config])
    found = _measured(writes, recompute)
    _report(found, writes.config, out, png)
    _print(found, out, json)


def _method(method: str | None, passes: int | None, no_preload: bool) -> dict[str, object]:
    """Return the keys of how it is measured: who asks for passes means the stepped sine."""
    preload = 0.0 if no_preload else None
    return {
        "characterisation.method": "stepped" if passes is not None and method is None else method,
        "characterisation.passes": passes,
        "characterisation.preload": preload,
        "characterisation.operating": preload,
    }


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


def _calibrated(writes: Output[RigConfig], raw: RawFolder) -> Calibration:
    rig = writes.config
    if writes.is_recomputed:
        return calibrate(rig, raw, refuse_to_emit, writes.provenance)
    with stoppable() as stop, LiveLine(rig, raw, stop) as line:
        try:
            return calibrate(rig, raw, line.emit, writes.provenance)
        except Stopped:
            raise Stopped(writes.left) from None


def _report(found: Calibration, rig: RigConfig, out: Path, png: Path | None) -> None:
    report = sweep_report(found, rig)
    report.write(out.with_suffix(".html"))
    if png is not None:
        report.png(png)


def _print(found: Calibration, out: Path, json: str | None) -> None:
    stream, figures = words(json), sweep_figures(found)
    title = f"{out}: {figures['lines']} bins from {_duration(found.seconds)} of signal"
    print_table(title, BAND_HEAD, band_rows(found.matrix), stream)
    print_table("least certain", WORST_HEAD, worst_rows(found.matrix), stream)
    if found.levels is not None:
        table = level_table(found.levels)
        print_table("levels of a bin; distortion and noise re the multisine's", table.head, table.rows, stream)
    if found.far is not None:
        print_table("far field", FAR_FIELD_HEAD, far_field_rows(found.far), stream)
    if found.loudest is not None:
        print(f"the multisine's loudest bin is {found.loudest:.1f} dB re what the preload emits", file=stream)
    if found.over is not None:
        print(f"the loudest bin emitted is {found.over:+.1f} dB re {_limit(found.over)}", file=stream)
    if len(found.tones):
        print(f"{len(found.tones)} bins were measured again by a stepped sine", file=stream)
    if len(found.passes) > 1:
        moved, missed = figures["first_pass_median_difference"], figures["first_grid_worst_interpolation"]
        print(f"the first grid misses {100 * missed:.2g} % at worst between its bins", file=stream)
        print(f"from the first pass to the second the bins moved by {100 * moved:.2g} %, median", file=stream)
    print(f"report: {out.with_suffix('.html')}", file=stream)
    write_json(json, figures)


def _limit(over: float) -> str:
    """Return which limit that is, and how a calibration keeps it."""
    return f"the limit that a shot of the reference has{'; --quiet keeps it here as well' if over > 0 else ''}"


def _duration(seconds: float) -> str:
    return f"{seconds / 60:.1f} min" if seconds >= 120 else f"{seconds:.1f} s"
