"""The command `calibrate response`."""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from calibration.frequency_domain.identify import MOST, Measured, identify_response, merged
from calibration.frequency_domain.report import FIT_HEAD, MODE_HEAD, fit_figures, fit_rows, mode_rows, response_report
from calibration.frequency_domain.response_model import ResponseModel
from calibration.identification.arguments import channels_of, order_of
from calibration.identification.recordings import from_file
from calibration.names import refuse_inputs, refuse_taken
from calibration.output import AgainOption
from calibration.welch import frequency_response, spectra
from rigkit.command import JsonOption, print_table, words, write_json
from rigkit.written import made_folder, written_file
from vibractl.model_file import read_model

FilesArgument = Annotated[
    list[Path], typer.Argument(metavar="DATA", help="Vibrator models of one rig; with --inputs, one recording.")
]
InputsOption = Annotated[str | None, typer.Option(metavar="u1,u2", help="Channels of the drive in a recording.")]
OutputsOption = Annotated[str | None, typer.Option(metavar="y1,y2", help="Channels of the response in it.")]
SampledOption = Annotated[float | None, typer.Option(metavar="HZ", help="Rate of a recording, if not in the file.")]
ResolutionOption = Annotated[float, typer.Option(metavar="HZ", help="Resolution of a recording's response.")]
OrderOption = Annotated[str, typer.Option(metavar="auto|N", help="States of the model.")]
MostOption = Annotated[int, typer.Option(help="Largest order tried.")]
RateOption = Annotated[float | None, typer.Option(metavar="HZ", help="Rate of the model; default: continuous time.")]
BandOption = Annotated[tuple[float, float] | None, typer.Option(metavar="LOW HIGH", help="Hz, of the bins fitted.")]
NoDirectOption = Annotated[bool, typer.Option("--no-direct", help="Fix D = 0.")]


def response_command(
    data: FilesArgument,
    inputs: InputsOption = None,
    outputs: OutputsOption = None,
    sampled: SampledOption = None,
    resolution: ResolutionOption = 0.5,
    order: OrderOption = "auto",
    most: MostOption = MOST,
    rate: RateOption = None,
    band: BandOption = None,
    no_direct: NoDirectOption = False,
    out: Annotated[Path | None, written_file("FILE", "Model file; the report goes beside it.")] = None,
    png: Annotated[Path | None, made_folder("DIR", "Write the figures as PNG files.")] = None,
    again: AgainOption = False,
    json: JsonOption = None,
) -> None:
    """Fit a state-space model to frequency responses: of vibrator models, or of a recording by Welch's method.

    Several models are merged, bin by bin, each with its variance.

    Example: `calibrate response model.h5 --order 24 --out modes.h5`;
    `calibrate response sweep.csv --inputs u --outputs y --band 5 200 --out modes.h5`
    """
    states = order_of(order)
    if most < 1:
        raise ValueError(f"--most is {most}, must be >= 1")
    if out is not None:
        made = [out, out.with_suffix(".html")]
        refuse_inputs(made, data)
        refuse_taken(made, again)
    measured = _within(_read(data, inputs, outputs, sampled, resolution), band)
    found = identify_response(*measured, rate=rate, order=states, most=most, direct=not no_direct)
    source = ", ".join(map(str, data))
    if out is not None:
        found.save(out, source=source)
    _report(found, measured, source, out, png)
    stream = words(json)
    print_table(f"{source}: {found.told}", FIT_HEAD, fit_rows(found, measured), stream)
    print_table("modes, +- one standard error", MODE_HEAD, mode_rows(found), stream)
    if out is not None:
        stream.write(f"report: {out.with_suffix('.html')}\n")
    write_json(json, fit_figures(found, measured))


def _report(found: ResponseModel, measured: Measured, source: str, out: Path | None, png: Path | None) -> None:
    """Write the page and the pictures that are asked for."""
    if out is None and png is None:
        return
    report = response_report(found, measured, source)
    if out is not None:
        report.write(out.with_suffix(".html"))
    if png is not None:
        report.png(png)


def _read(
    data: list[Path], inputs: str | None, outputs: str | None, sampled: float | None, resolution: float
) -> Measured:
    """Read the responses of vibrator models, or estimate that of a recording."""
    if inputs is None and outputs is None:
        parts = [read_model(path) for path in data]
        for path, part in zip(data, parts, strict=True):
            if part.response.shape[1:] != parts[0].response.shape[1:]:
                raise ValueError(
                    f"{path} is of {part.inputs} coils and {part.outputs} sensors, must be of {parts[0].inputs} and "
                    f"{parts[0].outputs} as {data[0]} is"
                )
        covered = [(each, each.covers(each.frequency)) for each in parts]
        return merged([(each.frequency[at], each.response[at], each.variance[at]) for each, at in covered])
    if len(data) != 1 or inputs is None or outputs is None:
        raise ValueError(f"--inputs and --outputs are of one recording, there are {len(data)} files; name both")
    if not resolution > 0:
        raise ValueError(f"--resolution is {resolution:g} Hz, must be > 0")
    read = from_file(data[0], channels_of("--inputs", inputs), channels_of("--outputs", outputs), sampled)
    (recording,), count = read.recordings, read.inputs
    found = frequency_response(
        spectra(recording.data[:, :count], recording.data[:, count:], recording.rate, resolution)
    )
    known = (found.frequency > 0) & (found.frequency < recording.rate / 2)
    known &= np.isfinite(found.variance).all(axis=(1, 2))
    return found.frequency[known], found.response[known], found.variance[known]


def _within(measured: Measured, band: tuple[float, float] | None) -> Measured:
    """Leave out what is not in the band."""
    if band is None:
        return measured
    frequency, response, variance = measured
    low, high = band
    inside = (frequency >= low) & (frequency <= high)
    if not (low < high and inside.any()):
        raise ValueError(
            f"--band is {low:g} to {high:g} Hz, must hold bins of {frequency[0]:g} to {frequency[-1]:g} Hz"
        )
    return frequency[inside], response[inside], variance[inside]
