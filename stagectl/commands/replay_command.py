"""`stagectl replay`."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from ctlblocks import recording
from rigkit.command import JsonOption, RunArgument, SetOption, print_table, words, write_json
from rigkit.experiment.foreign import EACH, Column, columns_of, record_of
from rigkit.experiment.replayed import Replayed
from rigkit.run_origin import say_at_work
from rigkit.written import written_file
from stagectl.commands.changed import say_changed
from stagectl.commands.kinds_of_run import remade, replayed


def replay_command(
    path: RunArgument,
    log: Annotated[
        Path | None,
        typer.Option("--from", metavar="LOG", help="A log of other origin, in place of the run's sensors."),
    ] = None,
    columns: Annotated[
        list[str] | None, typer.Option("--map", metavar="CHANNEL=COLUMN", help=f"With --from, of each channel: {EACH}.")
    ] = None,
    rate: Annotated[float | None, typer.Option(help="With --from: samples/s, if not in the log.")] = None,
    out: Annotated[Path | None, written_file("FILE", "With --from: a .csv or .wav for the outputs.")] = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Recompute every output of a run from its recorded sensors; status 1 if one differs from the recorded one.

    With --set it gives the outputs of other settings for the same sensors.  With --from the controllers are those of
    the run, and the sensors another program's log (CSV, WAV, HDF5, MAT, Parquet, MCAP): a column for each channel.

    Examples: `stagectl replay RUN/`, `stagectl replay RUN/ --set midranging.valve.feed=1.0`,
    `stagectl replay RUN/ --from LOG.csv --map position=gauge*1e-6,control==0 --out MADE.csv`
    """
    if log is not None:
        _replay_log(path, log, columns_of(columns or ()), rate, out, settings or (), json)
        return
    for name, given in (("--map", columns), ("--rate", rate), ("--out", out)):
        if given is not None:
            raise ValueError(f"{name} goes with --from LOG, which is not given")
    say_changed(path)
    say_at_work(path)
    done = _collected(replayed(path, settings or ()))
    rows = [
        [each.recording, each.channel, "yes" if each.identical else "no", f"{each.difference:.3g} {each.unit}"]
        for each in done
    ]
    print_table(
        f"{path}: outputs made again from the recorded sensors",
        ["recording", "channel", "bit for bit", "largest difference"],
        rows,
        words(json),
    )
    differ = sum(not each.identical for each in done)
    write_json(json, {"channels": len(done), "differing": differ})
    if settings:
        sys.stderr.write("the sensors are as they were recorded: they do not react to what is changed\n")
    elif differ:
        raise typer.Exit(1)


def _replay_log(
    path: Path,
    log: Path,
    columns: Mapping[str, Column],
    rate: float | None,
    out: Path | None,
    settings: Sequence[str],
    json: str | None,
) -> None:
    """Put somebody's log through the controllers of a run, and tell what they make of it."""
    if out is not None and out.suffix not in (".csv", ".wav"):
        raise ValueError(f"--out is {out}, must end in .csv or .wav")
    given, made = remade(path, settings, lambda like, names: record_of(log, columns, like, names, rate))
    rows, differences = [], {}
    for name, unit, values in zip(made.names, made.units, made.data.T, strict=True):
        beside = "-"
        if name in given.names:
            differences[name] = float(np.abs(values - given.select([name]).data[: len(values), 0]).max())
            beside = f"{differences[name]:.3g} {unit}"
        rows.append([name, f"{values.min():.4g} {unit}", f"{values.max():.4g} {unit}", beside])
    head = ["channel", "least", "largest", "largest difference from the log"]
    print_table(f"{path}: what its controllers make of {log}", head, rows, words(json))
    if out is not None:
        recording.write(out, made)
    write_json(json, {"samples": len(made.data), "differences": differences})
    sys.stderr.write("the sensors are as they were recorded: they do not react to what is made of them\n")


def _collected(again: Iterator[Replayed]) -> list[Replayed]:
    """Return what was made again; say beforehand how long that takes, and then each recording that is done."""
    sys.stderr.write("making every recording again takes about as long as a simulation of the run\n")
    done: list[Replayed] = []
    for each in again:
        if not done or done[-1].recording != each.recording:
            sys.stderr.write(f"made again: {each.recording}\n")
        done.append(each)
    return done
