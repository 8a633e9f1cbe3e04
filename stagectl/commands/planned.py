"""What `stagectl plan` does: pockets are milled by a planner, or a path is checked, and what came of it is told."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import typer

from rigkit import atomic
from rigkit import config as rig_file
from rigkit.command import print_table, words, write_json
from rigkit.experiment.runner import Conduct
from rigkit.progress import progress
from rigkit.stop import Stopped, stoppable
from stagectl.experiments.feed.simulated import simulated_pockets
from stagectl.planning.cutting import Cutting
from stagectl.planning.exact import least_time
from stagectl.planning.milling import Milled, Planner, mill, total
from stagectl.planning.pocket import Pocket, check, planner, untrained
from stagectl.planning.pocket_file import read_path, write_path
from stagectl.planning.report import TYPE_HEAD, learned_types, type_rows, write_report
from stagectl.planning.segment_file import read_segments, write_segments
from stagectl.planning.toolpath import gcode, rapid
from stagectl.robot.config import CellConfig


def trained(
    name: str, pocket: Pocket, is_untrained: bool, seed: int, prior: Path | None, learn: Path | None
) -> Planner:
    """Make a planner, which has learned from the segments in `learn` where that is given."""
    if is_untrained and prior is not None:
        raise ValueError(f"--untrained has no prior of the rates, must be left out with --prior {prior}")
    made = untrained(name, pocket) if is_untrained else planner(name, pocket, seed, prior)
    for segment in read_segments(learn, pocket) if learn is not None else ():
        made.learn(segment)
    return made


def cell_of(config: Path | None, settings: list[str] | None) -> CellConfig:
    """Read the file of the cell in which pockets are milled."""
    return rig_file.load(config, CellConfig, settings or [])


def milled(pocket: Pocket, made: Planner, pockets: int, cell: CellConfig | None) -> list[list[Milled]]:
    """Mill pockets at what is really paid, or in the simulated cell where there is a file of it."""
    if cell is None:
        return [mill(pocket, made) for _ in range(pockets)]
    with stoppable() as stop, progress("cells milled", pocket.rows * pocket.cols * pockets) as meter:
        meter.say("cells milled: in the simulated cell, where a pocket of 30 x 30 takes some fifteen seconds")
        try:
            return simulated_pockets(cell, pocket, made, pockets, Conduct(lambda: stop.made, show=meter.show))
        except ValueError:
            if stop.made:
                raise Stopped("stopped; nothing is stored") from None
            raise


def check_path(pocket: Pocket, path_file: Path, json: str | None) -> None:
    """Say whether a path mills a pocket, and by how much it is over the optimum; status 1 where it does not."""
    verdict = check(pocket, read_path(path_file))
    optimum = least_time(pocket)
    found: dict[str, Any] = {
        "legal": verdict.error is None,
        "complete": verdict.complete,
        "error": verdict.error,
        "left": verdict.left,
        "total": verdict.total,
        "optimum": optimum,
        "gap": verdict.total / optimum - 1.0 if verdict.complete else None,
    }
    said = [verdict.error or "legal"]
    if not verdict.complete:
        said.append(f"leaves {verdict.left} of {pocket.rows * pocket.cols} cells")
    gap = f", {100 * found['gap']:.2f} % over the optimum, {optimum:.2f} s" if verdict.complete else ""
    print(f"{path_file}: {'; '.join(said)}: {verdict.total:.2f} s{gap}", file=words(json))  # noqa: T201
    write_json(json, found)
    if not verdict.complete:
        raise typer.Exit(1)


@dataclass(frozen=True)
class Written:
    """Files that were asked for: segments of all pockets, and the last one's path, as it is, as G-code, as RAPID."""

    record: Path | None
    out: Path | None
    gcode: Path | None
    rapid: Path | None


def write(done: list[list[Milled]], pocket: Pocket, cutting: Cutting, files: Written) -> None:
    """Write what was asked for."""
    if files.record is not None:
        write_segments(files.record, done)
    if files.out is not None:
        write_path(files.out, [each.in_path for each in done[-1]])
    for file, written in ((files.gcode, gcode), (files.rapid, rapid)):
        if file is not None:
            atomic.write(file, written(done[-1], pocket, cutting))


def tell(done: list[list[Milled]], pocket: Pocket, name: str, page: Path | None, json: str | None) -> None:
    """Print times, paths and types, and write the page and the figures that were asked for."""
    optimum, stream = least_time(pocket), words(json)
    known = learned_types((segment for each in done for segment in each), pocket)
    times = [total(each) for each in done]
    rows = [
        [f"{number}", f"{time:.2f}", f"{100 * (time / optimum - 1):.2f}", f"{len(each)}",
         " ".join(f"{'^' if segment.is_lifted else ''}{segment.name}" for segment in each)]
        for number, (time, each) in enumerate(zip(times, done, strict=True), start=1)
    ]  # fmt: skip
    head = ["pocket", "time, s", "over the optimum, %", "segments", "path; ^ is a lift"]
    print_table(f"{name}; the optimum is {optimum:.2f} s", head, rows, stream)
    print_table("milling types", list(TYPE_HEAD), type_rows(known), stream)
    if page is not None:
        write_report(page, done, pocket, name, optimum, known)
        print(f"report: {page}", file=stream)  # noqa: T201
    found = {
        "planner": name,
        "optimum": optimum,
        "pockets": [
            {"total": time, "gap": time / optimum - 1.0, "path": [segment.in_path for segment in each]}
            for time, each in zip(times, done, strict=True)
        ],
        "types": {
            each.name: {"segments": each.count, "mean": each.mean, "deviation": each.deviation} for each in known
        },
    }
    write_json(json, found)
