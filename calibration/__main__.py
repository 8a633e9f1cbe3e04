"""The command line `calibrate`."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from calibration.experiment import RawFolder
from calibration.sweep_report import sweep_report
from calibration.sweep_summary import BAND_HEAD, WORST_HEAD, band_rows, sweep_figures, worst_rows
from calibration.vibrator import Calibration, LiveLine, calibrate
from calibration.vibrator_sweep import refuse_unfit
from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, application, print_table, run, words, write_json
from rigkit.stop import Stopped, stoppable
from vibractl.config import RigConfig
from vibractl.model_file import write_model

app = application("Experiments that end in a model file.")


@app.command("vibrator")
def vibrator_command(
    out: Annotated[Path, typer.Option(metavar="FILE", help="Model file to write; recordings and report go beside it.")],
    config: ConfigOption = None,
    seed: Annotated[int | None, typer.Option(help="Which simulated vibrator.")] = None,
    passes: Annotated[int | None, typer.Option(help="2: once more, on a grid refined from the first pass.")] = None,
    no_preload: Annotated[bool, typer.Option("--no-preload", help="Leave the preload out, for comparison.")] = False,
    png: Annotated[Path | None, typer.Option(metavar="DIR", help="Write the figures as PNG files as well.")] = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Measure a vibrator's transfer matrix by a preloaded stepped sine.

    Raw recordings are kept in a folder beside the model; stopped or killed, the same command goes on from there.

    Example: `calibrate vibrator --config rig.toml --out model.h5`
    """
    flags = {"simulator.options.seed": seed, "characterisation.passes": passes}
    laid_over = [*(settings or []), *(f"{key}={value}" for key, value in flags.items() if value is not None)]
    if no_preload:
        laid_over.append("characterisation.preload=0.0")
    rig = rig_file.load(config, RigConfig, laid_over)
    refuse_unfit(rig)
    with RawFolder(_raw_folder(out)) as raw:
        found = _calibrated(rig, raw)
        write_model(out, found.matrix)
    report = sweep_report(found, rig)
    report.write(out.with_suffix(".html"))
    if png is not None:
        report.png(png)
    _print(found, out, json)


def _raw_folder(out: Path) -> Path:
    """Return where the recordings go, unless the model would take the place of something else."""
    folder = out.with_suffix(".raw")
    if not out.parent.is_dir():
        raise ValueError(f"--out {out}: there is no folder {out.parent}")
    if out.suffix != ".h5":
        raise ValueError(f"--out {out}: the suffix is {out.suffix!r}, must be '.h5'")
    if out.exists() and not (out.is_file() and folder.is_dir()):
        raise ValueError(f"--out {out}: is there already, without its recordings in {folder}/; choose another name")
    return folder


def _calibrated(rig: RigConfig, raw: RawFolder) -> Calibration:
    with stoppable() as stop, LiveLine(rig, raw, stop) as line:
        try:
            return calibrate(rig, raw, line.emit)
        except Stopped:
            raise Stopped(f"stopped; what is recorded is in {raw.path}/, the same command goes on from there") from None


def _print(found: Calibration, out: Path, json: str | None) -> None:
    stream, figures = words(json), sweep_figures(found)
    title = f"{out}: {figures['lines']} lines from {found.seconds / 60:.1f} min of signal"
    print_table(title, BAND_HEAD, band_rows(found.matrix), stream)
    print_table("least certain", WORST_HEAD, worst_rows(found.matrix), stream)
    if len(found.passes) > 1:
        moved, missed = figures["first_pass_median_difference"], figures["first_grid_worst_interpolation"]
        print(f"the first grid misses {100 * missed:.2g} % at worst between its lines", file=stream)
        print(f"from the first pass to the second the lines moved by {100 * moved:.2g} %, median", file=stream)
    print(f"report: {out.with_suffix('.html')}", file=stream)
    write_json(json, figures)


def main() -> int:
    """Run the command line and return its exit status."""
    return run(app, "calibration", "vibractl")


if __name__ == "__main__":
    sys.exit(main())
