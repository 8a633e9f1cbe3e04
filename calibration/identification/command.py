"""The command `calibrate identify`."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal, cast, get_args

import typer

from calibration.from_command import CorrectClockOption, MapOption
from calibration.identification.arguments import channels_of, delay_of, order_of
from calibration.identification.beginnings import begun_together
from calibration.identification.excitation import excitation_notes
from calibration.identification.lower_rate import lower_rate_hint
from calibration.identification.recordings import Measured, from_file, from_pairs, without_outliers
from calibration.identification.report import (
    MODE_HEAD,
    candidate_table,
    fit_table,
    identification_figures,
    identification_report,
    mode_rows,
    pair_notes,
    record_notes,
    verdicts,
)
from calibration.identification.thinning import shortest_stretch, thinned_recordings, thinning_note
from calibration.identification.workflow import (
    METHODS,
    REFINED,
    STEPS,
    Identification,
    Plant,
    identify_recordings,
    shortest_recording,
)
from calibration.names import raw_folder, refuse_inputs, refuse_taken
from calibration.output import AgainOption
from calibration.subspace.outliers import Outliers
from calibration.subspace.signals import Detrend
from rigkit.command import JsonOption, print_table, words, write_json
from rigkit.progress import progress
from rigkit.written import made_folder, written_file
from stagectl.models.model_file import write_model
from vibractl.foreign.tracks import parsed_map

NO_INPUTS = "none"
LARGE = 100_000
"""Numbers in a measurement from which on it is said how long it may take."""

FilesArgument = Annotated[
    list[Path] | None,
    typer.Argument(metavar="DATA", help="CSV, WAV, FLAC, HDF5 or MAT file; with --from the second file of each."),
]
InputsOption = Annotated[
    str | None,
    typer.Option(metavar="u1,u2", help="Channels of the drive in DATA: names, numbers, datasets; none: time series."),
]
OutputsOption = Annotated[str | None, typer.Option(metavar="y1,y2", help="Channels of the response in DATA.")]
FromOption = Annotated[
    list[Path] | None,
    typer.Option("--from", metavar="D R", help="A recording in two files: drives, responses; may be repeated."),
]

OutliersOption = Annotated[str, typer.Option(metavar="replace|keep", help="Isolated outliers of outputs.")]
DelayOption = Annotated[
    str, typer.Option(metavar="auto|N[,N]", help="Dead time in samples: of all inputs, or of each.")
]
DetrendOption = Annotated[
    str, typer.Option(metavar="|".join(get_args(Detrend)), help="What is taken away: the mean of all, or of each ...")
]
UnstableOption = Annotated[bool, typer.Option("--unstable", help="The plant may be unstable or integrate.")]
NoDirectOption = Annotated[bool, typer.Option("--no-direct", help="Fix D = 0.")]
SecondsOption = Annotated[float, typer.Option(metavar="S", help="Time limit of pem.")]


def identify_command(
    data: FilesArgument = None,
    inputs: InputsOption = None,
    outputs: OutputsOption = None,
    drives: FromOption = None,
    channels: MapOption = None,
    order: Annotated[str, typer.Option(metavar="auto|N", help="States of the model.")] = "auto",
    method: Annotated[str, typer.Option(metavar="|".join(METHODS), help="pem: auto, then refined.")] = "auto",
    rate: Annotated[float | None, typer.Option(help="Samples/s, if not in the file.")] = None,
    decimate: Annotated[int, typer.Option(metavar="N", help="Keep every N-th sample behind a low-pass.")] = 1,
    correct_clock: CorrectClockOption = False,
    horizon: Annotated[int | None, typer.Option(help="Past and future samples of a window.")] = None,
    hold_back: Annotated[float, typer.Option("--hold-back", help="Share at the end used as validation data.")] = 0.3,
    outliers: OutliersOption = "replace",
    delay: DelayOption = "auto",
    detrend: DetrendOption = "mean",
    unstable: UnstableOption = False,
    no_direct: NoDirectOption = False,
    seconds: SecondsOption = REFINED,
    out: Annotated[Path | None, written_file("FILE", "Model file; the report goes beside it.")] = None,
    png: Annotated[Path | None, made_folder("DIR", "Write the figures as PNG files.")] = None,
    again: AgainOption = False,
    json: JsonOption = None,
) -> None:
    """Identify a state-space model from measurements, and judge it on validation data.

    Example: `calibrate identify sweep.csv --inputs u --outputs y1,y2 --rate 1000 --out model.h5`; drives and responses
    in two files, or several recordings:
    `calibrate identify --from drive.wav heard.wav --decimate 20 --out model.h5`
    """
    wanted: dict[str, Any] = {"order": order_of(order), "plant": _plant(delay, detrend, unstable, no_direct)}
    made = _made(out, [*(data or []), *(drives or [])], again)
    at_least = shortest_stretch(max(decimate, 1), shortest_recording(hold_back))
    given = _read(data or [], drives or [], (inputs, outputs, channels), rate, at_least)
    measured = _made_ready(given, decimate, correct_clock, cast(Outliers, outliers))
    wanted |= {"method": method, "horizon": horizon, "hold_back": hold_back, "outliers": outliers, "seconds": seconds}
    found = _identified(measured, wanted)
    refuse_taken(made, again)
    _write(found, measured, out, png)
    _print(found, measured, out, json)


def _identified(measured: Measured, wanted: dict[str, Any]) -> Identification:
    """Identify, with how far it is; `wanted` are arguments of `identify_recordings`."""
    with _watched(measured) as show:
        return identify_recordings(measured.recordings, measured.inputs, show=show, **wanted)


def _plant(delay: str, detrend: str, unstable: bool, no_direct: bool) -> Plant:
    """Return what is known of the plant; refuse words that say nothing."""
    if detrend not in get_args(Detrend):
        raise ValueError(f"--detrend is {detrend!r}, must be one of {', '.join(get_args(Detrend))}")
    direct: Literal["auto"] | bool = False if no_direct else "auto"
    return Plant(not unstable, delay_of(delay), cast(Detrend, detrend), direct)


def _made(out: Path | None, given: Sequence[Path], again: bool) -> list[Path]:
    """Return what will be written; refuse what is no name of a model, or given, or there unless `again`."""
    if out is None:
        return []
    raw_folder(out)
    made = [out, out.with_suffix(".html")]
    refuse_inputs(made, given)
    if not again:
        refuse_taken(made, again)
    return made


def _write(found: Identification, measured: Measured, out: Path | None, png: Path | None) -> None:
    """Write the model and its page, and the pictures, where they are wanted."""
    if out is None and png is None:
        return
    report = identification_report(found, measured.source, measured.notes)
    if out is not None:
        write_model(out, found.model)
        report.write(out.with_suffix(".html"))
    if png is not None:
        report.png(png)


@contextmanager
def _watched(measured: Measured) -> Iterator[Callable[[int, str], None]]:
    """Show how far it is; before much data, how long it may take."""
    samples, channels = measured.samples, len(measured.recordings[0].names)
    with progress("identifying", STEPS) as meter:
        if samples * channels > LARGE:
            meter.say(
                f"identifying: {samples} samples of {channels} channels; 250 000 samples of four take half a minute, "
                "with pem longer"
            )
        if hint := lower_rate_hint(measured.recordings):
            meter.say(f"identifying: {hint}")
        yield meter.show
        meter.show(STEPS)


def _read(
    data: Sequence[Path],
    drives: Sequence[Path],
    named: tuple[str | None, str | None, str | None],
    rate: float | None,
    at_least: int,
) -> Measured:
    """Read what is given: one file whose channels are named, or pairs of files."""
    inputs, outputs, channels = named
    if rate is not None and not 0 < rate < float("inf"):
        raise ValueError(f"--rate is {rate}, must be > 0 samples/s")
    if drives:
        if inputs is not None or outputs is not None:
            raise ValueError("--inputs or --outputs and --from are given, must be one of them: --map says the channels")
        return _labelled(from_pairs(drives, data, parsed_map(channels), rate))
    if channels is not None:
        raise ValueError("--map is given without --from, must be with it: --inputs and --outputs say the channels")
    if len(data) != 1:
        raise ValueError(f"{len(data)} files are given, must be one, or pairs of drives and responses: --from D R")
    wanted = [] if inputs == NO_INPUTS else channels_of("--inputs", inputs), channels_of("--outputs", outputs)
    return _labelled(from_file(data[0], *wanted, rate, at_least))


def _labelled(measured: Measured) -> Measured:
    """Say in each recording which files all of it came from."""
    words = {"recording": measured.source}
    labelled = (replace(each, provenance={**each.provenance, **words}) for each in measured.recordings)
    return replace(measured, recordings=tuple(labelled))


def _made_ready(measured: Measured, factor: int, correct_clock: bool, outliers: Outliers) -> Measured:
    """Lower the rate, once outliers are gone that it would spread, and look at how responses lie beside drives then."""
    if factor > 1:
        measured = without_outliers(measured, outliers)
    thin = thinned_recordings(measured.recordings, measured.names, factor)
    beside = begun_together(measured, thin, factor, correct_clock)
    if beside.recordings != measured.recordings:
        thin = thinned_recordings(beside.recordings, measured.names, factor)
    notes = [thinning_note(thin[0].rate, factor, len(thin))] if factor > 1 else []
    return replace(measured, recordings=tuple(thin), notes=(*beside.notes, *notes))


def _print(found: Identification, measured: Measured, out: Path | None, json: str | None) -> None:
    stream, model = words(json), found.model
    title = f"{measured.source}: order {found.order} by {found.method}, {len(found.response)}validation samples"
    fits, tried = fit_table(found), candidate_table(found)
    print_table(title, fits.head, fits.rows, stream)
    print_table("modes, with one standard error", MODE_HEAD, mode_rows(found), stream)
    if tried.rows:
        print_table("orders", tried.head, tried.rows, stream)
    values = found.started.singular_values
    shown = ", ".join(f"{value:.3g}" for value in values[: found.order + 3])
    stream.write(f"singular values: {shown}{' ...' if len(values) > found.order + 3 else ''}\n")
    said = (*verdicts(found), *record_notes(found), *excitation_notes(found.nearly), *pair_notes(found))
    for sentence in (*measured.notes, *said):
        stream.write(f"{sentence}\n")
    if not model.is_stable:
        stream.write("the model is not stable\n")
    if out is not None:
        stream.write(f"report: {out.with_suffix('.html')}\n")
    recordings = {"recordings": list(measured.names), "notes": list(measured.notes)}
    write_json(json, identification_figures(found) | recordings)
