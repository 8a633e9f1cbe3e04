"""The command `calibrate hysteresis`."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from calibration.hysteresis import PLAYS, Settings, fit
from calibration.hysteresis_report import FIT_HEAD, Judged, fit_rows, hysteresis_figures, hysteresis_report, judged
from calibration.names import raw_folder, refuse_inputs, refuse_taken
from calibration.output import AgainOption
from rigkit.command import JsonOption, print_table, words, write_json
from rigkit.foreign_record import read_channels
from rigkit.provenance import now, software
from rigkit.written import made_folder, written_file
from stagectl.stage.hysteresis_file import write_hysteresis

METRES = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9}
VOLTS = {"V": 1.0, "mV": 1e-3, "kV": 1e3, "1": 1.0}


def hysteresis_command(
    data: Annotated[Path, typer.Argument(metavar="DATA", help="CSV, WAV, FLAC, HDF5 or MAT file.")],
    input_channel: Annotated[str, typer.Option("--input", metavar="u", help="Channel of the voltage.")],
    output_channel: Annotated[str, typer.Option("--output", metavar="y", help="Channel of the displacement.")],
    out: Annotated[Path, written_file("FILE", "Model file; the report goes beside it.")],
    rate: Annotated[float | None, typer.Option(help="Samples/s, if not in the file.")] = None,
    unit: Annotated[str | None, typer.Option(metavar="um", help="Unit of the output, if not in the file.")] = None,
    skip: Annotated[float, typer.Option(metavar="S", help="Seconds at the start to leave out.")] = 0.0,
    hold_back: Annotated[float, typer.Option("--hold-back", help="Share at the end used as validation data.")] = 0.3,
    plays: Annotated[int, typer.Option(help="Plays of the model.")] = PLAYS,
    delay: Annotated[int, typer.Option(help="Samples from voltage to output.")] = 1,
    lag: Annotated[bool, typer.Option("--lag", help="Fit a lag too; the record must have several rates.")] = False,
    png: Annotated[Path | None, made_folder("DIR", "Write the figures as PNG files.")] = None,
    again: AgainOption = False,
    json: JsonOption = None,
) -> None:
    """Fit an invertible hysteresis model to a voltage and the displacement, and judge it on validation data.

    Example: `calibrate hysteresis loops.csv --input 1 --output 5 --rate 200 --unit um --out stack.h5`
    """
    _refuse_unfit(out, skip, hold_back)
    made = [out, out.with_suffix(".html")]
    refuse_inputs(made, [data])
    measured = read_channels(data, [input_channel, output_channel], rate)
    volts = _scale("--input", measured.units[0], VOLTS)
    metres = _scale("--output", unit or measured.units[1], METRES)
    voltage, moved = volts * measured.data[:, 0].astype(float), metres * measured.data[:, 1].astype(float)
    first, last = round(skip * measured.rate), round((1 - hold_back) * len(moved))
    if not first < last:
        raise ValueError(f"--skip is {skip:g} s, must be less than the {last / measured.rate:g} s that are fitted")
    found = fit(voltage, moved, measured.rate, slice(first, last), Settings(plays, delay, lag))
    origin = {"recording": str(data), "computed": now(), "software": software()}
    found = replace(found, model=replace(found.model, provenance=origin))
    refuse_taken(made, again)
    write_hysteresis(out, found.model)
    result = judged(found, voltage, moved)
    report = hysteresis_report(result, str(data))
    report.write(out.with_suffix(".html"))
    if png is not None:
        report.png(png)
    _print(result, data, out, json)


def _refuse_unfit(out: Path, skip: float, hold_back: float) -> None:
    raw_folder(out)  # refuses what is no name of a model
    if not 0 <= skip < float("inf"):
        raise ValueError(f"--skip is {skip:g} s, must be >= 0")
    if not 0.05 <= hold_back <= 0.9:
        raise ValueError(f"--hold-back is {hold_back:g}, must be 0.05 to 0.9")


def _scale(option: str, unit: str, known: dict[str, float]) -> float:
    if unit not in known:
        say = "; give it with --unit" if option == "--output" else ""
        raise ValueError(f"{option}: the unit is {unit!r}, must be one of {', '.join(known)}{say}")
    return known[unit]


def _print(result: Judged, data: Path, out: Path, json: str | None) -> None:
    stream, model = words(json), result.found.model
    title = f"{data}: {len(model.weights)} plays over {model.low:g} to {model.high:g} V"
    print_table(title, FIT_HEAD, fit_rows(result), stream)
    stream.write(f"the widest loop opens by {100 * result.opening:.1f} % of its span\n")
    if model.lag > 0:
        stream.write(f"lag: {1e3 * model.lag:.3g} ms\n")
    stream.write(f"report: {out.with_suffix('.html')}\n")
    write_json(json, hysteresis_figures(result))
