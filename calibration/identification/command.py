"""The command `calibrate identify`."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, cast

import typer

from calibration.identification.report import (
    CANDIDATE_HEAD,
    FIT_HEAD,
    MODE_HEAD,
    candidate_rows,
    fit_rows,
    identification_figures,
    identification_report,
    mode_rows,
    verdicts,
)
from calibration.identification.workflow import STEPS, Identification, Method, identify_recording
from calibration.names import raw_folder, refuse_inputs, refuse_taken
from calibration.output import AgainOption
from ctlblocks.recording import Recording
from rigkit.command import JsonOption, print_table, words, write_json
from rigkit.foreign_record import read_channels
from rigkit.progress import progress
from rigkit.written import made_folder, written_file
from stagectl.model_file import write_model

LARGE = 100_000
"""Numbers in a measurement from which on it is said how long it may take."""


def identify_command(
    data: Annotated[Path, typer.Argument(metavar="DATA", help="CSV, WAV, FLAC, HDF5 or MAT file.")],
    inputs: Annotated[str, typer.Option(metavar="u1,u2", help="Channels of the drive: names, numbers, datasets.")],
    outputs: Annotated[str, typer.Option(metavar="y1,y2", help="Channels of the response.")],
    order: Annotated[str, typer.Option(metavar="auto|N", help="States of the model.")] = "auto",
    method: Annotated[str, typer.Option(metavar="moesp|n4sid|pem", help="pem: moesp, then refined.")] = "moesp",
    rate: Annotated[float | None, typer.Option(help="Samples a second, where the file does not say.")] = None,
    horizon: Annotated[int | None, typer.Option(help="Samples that the singular values look back and ahead.")] = None,
    hold_back: Annotated[float, typer.Option("--hold-back", help="Share kept, at the end, to judge by.")] = 0.3,
    out: Annotated[Path | None, written_file("FILE", "Model file; the report goes beside it.")] = None,
    png: Annotated[Path | None, made_folder("DIR", "Write the figures as PNG files.")] = None,
    again: AgainOption = False,
    json: JsonOption = None,
) -> None:
    """Identify a state-space model from a measurement, and judge it on samples held back.

    Example: `calibrate identify sweep.csv --inputs u --outputs y1,y2 --rate 1000 --out model.h5`
    """
    drives, responses = _channels("--inputs", inputs), _channels("--outputs", outputs)
    states = _order(order)
    if rate is not None and not 0 < rate < float("inf"):
        raise ValueError(f"--rate is {rate}, must be > 0 samples/s")
    if out is not None:
        raw_folder(out)  # refuses what is no name of a model
        refuse_inputs([out, out.with_suffix(".html")], [data])
    measured = _read(data, drives, responses, rate)
    with _watched(measured) as show:
        way = cast(Method, method)
        found = identify_recording(
            measured, len(drives), order=states, method=way, horizon=horizon, hold_back=hold_back, show=show
        )
    if out is not None:
        refuse_taken([out, out.with_suffix(".html")], again)
        write_model(out, found.model)
    if out is not None or png is not None:
        report = identification_report(found, str(data))
        if out is not None:
            report.write(out.with_suffix(".html"))
        if png is not None:
            report.png(png)
    _print(found, data, out, json)


@contextmanager
def _watched(measured: Recording) -> Iterator[Callable[[int, str], None]]:
    """Show how far it is; before much data, how long it may take."""
    samples, channels = measured.data.shape
    with progress("identifying", STEPS) as meter:
        if measured.data.size > LARGE:
            meter.say(
                f"identifying: {samples} samples of {channels} channels; 250 000 samples of four take half a minute, "
                "with pem longer"
            )
        yield meter.show
        meter.show(STEPS)


def _channels(option: str, text: str) -> list[str]:
    names = [name.strip() for name in text.split(",")]
    if not all(names):
        raise ValueError(f"{option} is {text!r}, must be names or numbers with commas between")
    return names


def _order(text: str) -> int | None:
    if text == "auto":
        return None
    if not (text.isdecimal() and int(text) >= 1):
        raise ValueError(f"--order is {text!r}, must be auto or a whole number >= 1")
    return int(text)


def _read(path: Path, drives: list[str], responses: list[str], rate: float | None) -> Recording:
    if both := set(drives) & set(responses):
        raise ValueError(f"{', '.join(sorted(both))}: cannot be input and output at once")
    measured = read_channels(path, [*drives, *responses], rate)
    return Recording(
        measured.names, measured.units, measured.rate, measured.data, {**measured.provenance, "recording": str(path)}
    )


def _print(found: Identification, data: Path, out: Path | None, json: str | None) -> None:
    stream, model = words(json), found.model
    title = f"{data}: order {model.order} by {found.method}, {len(found.response)} samples held back"
    print_table(title, FIT_HEAD, fit_rows(found), stream)
    print_table("modes, with one standard error", MODE_HEAD, mode_rows(found), stream)
    if found.started.candidates:
        print_table("orders", CANDIDATE_HEAD, candidate_rows(found), stream)
    values = found.started.singular_values
    shown = ", ".join(f"{value:.3g}" for value in values[: model.order + 3])
    stream.write(f"singular values: {shown}{' ...' if len(values) > model.order + 3 else ''}\n")
    for sentence in verdicts(found):
        stream.write(f"{sentence}\n")
    if not model.is_stable:
        stream.write("the model is not stable\n")
    if out is not None:
        stream.write(f"report: {out.with_suffix('.html')}\n")
    write_json(json, identification_figures(found))
