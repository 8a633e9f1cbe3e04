"""`calibrate vibrator --from`: a model from recordings that are there, whoever made them."""

import time
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import Annotated

import typer

from calibration.from_recordings import Found, matrix_from
from calibration.from_report import GAP_HEAD, RECORD_HEAD, from_figures, from_report, gap_rows, notes, record_rows
from calibration.from_verdict import VERDICT_HEAD, verdicts
from calibration.names import oldest, raw_folder, refuse_inputs, refuse_taken
from calibration.output import provenance
from calibration.recorded_signals import Recorded
from rigkit.command import print_table, words, write_json
from rigkit.large_arrays import give_back_large_arrays
from rigkit.progress import Meter, progress
from vibractl.config import RigConfig
from vibractl.foreign.signals import drives_of, responses_of
from vibractl.foreign.tracks import open_mapped, parsed_map
from vibractl.model_file import write_model

DrivesOption = Annotated[
    list[Path] | None,
    typer.Option("--from", metavar="D.wav R.wav", help="Use these recordings instead; may be repeated."),
]
ResponsesArgument = Annotated[list[Path] | None, typer.Argument(metavar="", help="The second file of each --from.")]
CorrectClockOption = Annotated[
    bool, typer.Option("--correct-clock", help="With --from: correct differences of the devices' clocks and start.")
]
MapOption = Annotated[
    str | None,
    typer.Option("--map", metavar="drive_1=3,...", help="Channels of --from by name or number; - inverts one."),
]


def refuse_measuring(options: Mapping[str, object]) -> None:
    """Refuse options that are for measuring where recordings are given.

    Parameters
    ----------
    options : mapping of str to any
        By name; those that are set are refused.
    """
    for name, value in options.items():
        if value:
            raise ValueError(f"{name} and --from are given, must be one of them: nothing is measured with --from")


def refuse_without_files(correct_clock: bool, channels: str | None) -> None:
    """Refuse options that are for recordings where none are given.

    Parameters
    ----------
    correct_clock : bool
    channels : str or None
    """
    if correct_clock:
        raise ValueError("--correct-clock is given without --from, must be with it: one device has one clock")
    if channels is not None:
        raise ValueError("--map is given without --from, must be with it: an experiment has those of the rig file")


def model_from_files(
    out: Path,
    drives: Sequence[Path],
    responses: Sequence[Path],
    channels: str | None,
    rig: RigConfig,
    inputs: Collection[Path | None] = (),
    *,
    correct_clock: bool = False,
    again: bool = False,
    png: Path | None = None,
    json: str | None = None,
) -> None:
    """Read the recordings, estimate the transfer matrix, and write model and report.

    Parameters
    ----------
    out : Path
    drives, responses : sequences of Path, as many of one as of the other
    channels : str or None
        Which are which, as of `vibractl.foreign.tracks.parsed_map`; one file may hold drives and responses.
    rig : RigConfig
    inputs : collection of Path
        Other files that were read, such as the rig file.
    correct_clock : bool
    again : bool
        Whether what is there is kept under its date.
    png : Path, optional
    json : str, optional

    Raises
    ------
    ValueError : files and rig do not fit, or no model comes of it; nothing is written.
    """
    if len(drives) != len(responses):
        raise ValueError(
            f"--from has {len(drives)} drives and {len(responses)} responses, must be a pair each time: "
            "--from D.wav R.wav"
        )
    raw_folder(out)  # refuses what is no name of a model
    page = out.with_suffix(".html")
    refuse_inputs([out, page], [*drives, *responses, *inputs])
    if not again:
        refuse_taken([out, page], again)
    given = parsed_map(channels)
    records = [opened_pair(*pair, rig, given) for pair in zip(drives, responses, strict=True)]
    about = provenance(rig, min(oldest(path) for path in responses), {})
    about |= {"recording": ", ".join(each.name for each in records)}
    give_back_large_arrays()
    seconds = sum((each.response.frames or 0) / each.rate for each in records)
    with progress("from recordings", seconds) as meter:
        tell = _telling(meter, seconds)
        found = matrix_from(records, rig, about, correct_clock, tell)
        tell(seconds)
    refuse_taken([out, page], again)
    write_model(out, found.matrix.described(seconds=f"{found.seconds:.1f}"))
    report = from_report(found, rig)
    report.write(page)
    if png is not None:
        report.png(png)
    _print(found, out, json)


def opened_pair(drive: Path, response: Path, rig: RigConfig, given: Mapping[str, str]) -> Recorded:
    """Open drives and responses that lie beside each other, in two files or one.

    Parameters
    ----------
    drive, response : Path
    rig : RigConfig
    given : mapping of str to str
        Channels by what they are, as of `vibractl.foreign.tracks.parsed_map`.

    Raises
    ------
    RecordingError : as of `vibractl.foreign.tracks.open_mapped`.
    """
    played = open_mapped(drive, drives_of(rig.audio), rig.audio.rate, given)
    heard = open_mapped(response, responses_of(rig.audio), rig.audio.rate, given)
    return Recorded(played, heard, rig.audio.input_full_scale)


def _telling(meter: Meter, total: float) -> Callable[[float], None]:
    """Return what shows how far it is, and how many times faster than it was recorded."""
    begun, read, last = time.monotonic(), 0.0, 0.0

    def told(seconds: float) -> None:
        nonlocal read, last
        read += seconds - last if seconds > last else 0.0  # less: a recording is read once more
        last = seconds
        speed = read / max(time.monotonic() - begun, 1e-3)
        meter.show(min(seconds, total), f"{speed:.0f} times real time")

    return told


def _print(found: Found, out: Path, json: str | None) -> None:
    stream = words(json)
    title = f"{out}: {len(found.matrix.frequency)} bins from {found.seconds:.1f} s of {len(found.records)} records"
    print_table(title, VERDICT_HEAD, [each.row for each in verdicts(found)], stream)
    print_table("records", RECORD_HEAD, record_rows(found), stream)
    if found.gaps:
        print_table("without values", GAP_HEAD, gap_rows(found), stream)
    for note in notes(found):
        stream.write(f"{note}\n")
    stream.write(f"report: {out.with_suffix('.html')}\n")
    write_json(json, from_figures(found))
