"""The command `calibrate stage`."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, cast

import typer

from calibration.experiment import RawFolder
from calibration.output import AgainOption, Output, RecomputeOption, Wish, output
from calibration.stage_axes import order as orders
from calibration.stage_axes.bench import Bench, ExcitedAxis, RecordedBench
from calibration.stage_axes.calibration import AxisCalibration, calibrate_axes
from calibration.stage_axes.experiment import KEPT, KIND, require_room
from calibration.stage_axes.files import ALL, axes_of, results, write
from calibration.stage_axes.live_bench import LiveBench
from calibration.stage_axes.report import (
    INNER_HEAD,
    MODEL_HEAD,
    OUTER_HEAD,
    calibration_figures,
    inner_row,
    model_rows,
    outer_row,
    without_loop,
)
from calibration.subspace.realization import Method
from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, PngOption, SetOption, laid_over, print_table, words, write_json
from rigkit.stop import Stopped, stoppable
from rigkit.written import written_file
from stagectl.config import StageConfig
from stagectl.link.stage_link import StageLink
from stagectl.stage.piezo_pid import Pid


def stage_command(
    out: Annotated[Path, written_file("FILE", "Model file; of all axes, stage.h5 makes stage-x.h5 ...")],
    axis: Annotated[str, typer.Option(metavar="x|y|z|all", help="Which axis.")] = ALL,
    config: ConfigOption = None,
    seed: Annotated[int | None, typer.Option(help="Seed of the simulated stage.")] = None,
    order: Annotated[int | None, typer.Option(help="States of the models of one position; else as proposed.")] = None,
    method: Annotated[str, typer.Option(metavar="moesp|n4sid", help="Subspace method.")] = "moesp",
    png: PngOption = None,
    live: Annotated[bool, typer.Option("--live", help="The stage behind its CAN adapter, link.channel.")] = False,
    again: AgainOption = False,
    recompute: RecomputeOption = False,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Identify axes of the stage by chirps: inner loop open, then closed; choose their PIDs and outer loops.

    Beside each model file: `-simo.h5` to all positions, `-open.h5` from the voltage, a report; and a rig file with PIDs
    and outer loops; status 1 if an axis has none.  Raw recordings are stored in a folder beside; after a stop or
    kill the same command continues there.

    Example: `calibrate stage --config stage.toml --axis x --out stage-x.h5`
    """
    over = laid_over(settings, {"simulator.options.seed": seed, "session.live": live})
    rig = rig_file.load(config, StageConfig, over)
    axes = axes_of(rig, axis)
    if order is not None and not 1 <= order <= orders.MOST:
        raise ValueError(f"--order is {order}, must be 1 to {orders.MOST}")
    if method not in ("moesp", "n4sid"):
        raise ValueError(f"--method is {method!r}, must be moesp or n4sid")
    made = results(rig, axis, out)
    writes = output(out, KIND, rig, Wish(again, recompute, accept or []), made, KEPT, inputs=[config])
    folder = RawFolder(writes.raw)
    if not recompute:
        require_room(rig, len(axes), folder)
    sys.stderr.write("".join(f"{note}\n" for note in writes.notes))
    with writes.begun(), folder as raw:
        found = _calibrated(writes, axes, raw, order, cast(Method, method))
        write(found, out, axis == ALL, writes.config, _text_of(config), png)
        writes.finish()
    _print(found, out, json)
    if any(without_loop(found)):
        raise typer.Exit(1)


def _text_of(config: Path | None) -> str:
    """Return the rig file as a person has written it; without one, a complete one."""
    return rig_file.example(StageConfig) if config is None else config.read_text(encoding="utf-8")


def _calibrated(
    writes: Output[StageConfig], axes: Sequence[int], raw: RawFolder, order: int | None, method: Method
) -> list[AxisCalibration]:
    rig, about = writes.config, writes.provenance
    with stoppable() as stop, _bench(writes, lambda: stop.made) as bench:
        try:
            return calibrate_axes(rig, axes, raw, order, method, bench, about)
        except Stopped:
            raise Stopped(writes.left) from None


@contextmanager
def _bench(
    writes: Output[StageConfig], stopped: Callable[[], bool]
) -> Iterator[Callable[[int, Pid | None], ExcitedAxis]]:
    """Give what excites an axis: of the stage behind its link where the run is live, else of the one in process."""
    rig = writes.config
    if writes.is_recomputed:
        yield lambda axis, loop: RecordedBench(rig, axis, loop)
        return
    if not rig.session.live:
        yield lambda axis, loop: Bench(rig, axis, loop, stopped)
        return
    with StageLink(rig.link) as link:
        yield lambda axis, loop: LiveBench(rig, axis, loop, link, stopped, _say)


def _say(text: str) -> None:
    sys.stderr.write(f"{text}\n")


def _print(found: Sequence[AxisCalibration], out: Path, json: str | None) -> None:
    stream = words(json)
    seconds = sum(each.opened.experiment.seconds + each.closed.experiment.seconds for each in found)
    rows = [row for each in found for row in model_rows(each)]
    print_table(f"{out}: {seconds:.0f} s of signal", MODEL_HEAD, rows, stream)
    print_table(f"inner loops, in {out.with_suffix('.toml')}", INNER_HEAD, map(inner_row, found), stream)
    print_table(f"outer loops, in {out.with_suffix('.toml')}", OUTER_HEAD, map(outer_row, found), stream)
    for line in without_loop(found):
        print(line, file=stream)
    write_json(json, calibration_figures(found))
