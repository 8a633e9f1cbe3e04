"""The command `calibrate joints`."""

import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, TextIO

import typer

from calibration.guided_arm import arm_with_tool
from calibration.joint_clamping import advice_table
from calibration.joint_clamping.full_stiffness import ArmStiffness
from calibration.joint_clamping.joints_file import write_joints
from calibration.joint_clamping.poses import in_poses
from calibration.joint_clamping.recorded_joints import missing
from calibration.joint_clamping.recorded_map import recorded_map
from calibration.joint_clamping.report import HEAD, figures, joints_report, rows
from calibration.joint_clamping.requests import requests
from calibration.joint_clamping.results import CLAMP, LINK, RAW, TOOL, Clamped, JointResult, of_recording
from calibration.joint_clamping.session import KEPT, KIND, Desk, measure
from calibration.joint_clamping.several_poses import experiment, stiffest, whole_arm
from calibration.names import raw_folder, refuse_inputs, refuse_taken
from calibration.output import AgainOption, Output, RecomputeOption, Wish, output
from calibration.raw_run import raw_run
from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, SetOption, laid_over, print_table, words, write_json
from rigkit.common_options import one_of
from rigkit.experiment.runner import Conduct
from rigkit.provenance import now, software
from rigkit.written import made_folder, written_file
from stagectl.robot.clamp_config import clamp_procedure
from stagectl.robot.config import CellConfig

WAY_OF = {"best": "", "none": RAW, "clamp": CLAMP, "tool": TOOL, "link": LINK}
"""What `--compensate` takes, and the way that is."""

PoseOption = Annotated[list[str] | None, typer.Option(metavar="DEG,...", help="Clamping pose; may be repeated.")]
CompensateOption = Annotated[
    str,
    typer.Option(metavar="WAY", help=f"Arm's side known by {', '.join(WAY_OF)}.", autocompletion=one_of(WAY_OF)),
]


def joints_command(
    config: ConfigOption = None,
    record: Annotated[Path | None, typer.Option("--from", metavar="MAP", help="Recorded: CSV, WAV, HDF5, MAT.")] = None,
    joints: Annotated[str, typer.Option(metavar="1-6", help="Which joints: numbers and ranges.")] = "1-6",
    out: Annotated[Path | None, written_file("FILE", "Model file; the report goes beside it.")] = None,
    live: Annotated[bool, typer.Option("--live", help="The robot of [robot].")] = False,
    pose: PoseOption = None,
    poses: Annotated[Path | None, typer.Option(metavar="FILE", help="Clamping poses, one a line, in deg.")] = None,
    compensate: CompensateOption = "best",
    advise: Annotated[bool, typer.Option("--advise", help="Advise where to clamp each joint; nothing moves.")] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Print every motion; nothing moves.")] = False,
    angle: Annotated[str, typer.Option(metavar="NAME", help="With --from: channel of the motor's angle.")] = "angle",
    torque: Annotated[str, typer.Option(metavar="NAME", help="With --from: channel of its torque.")] = "torque",
    link: Annotated[str | None, typer.Option(metavar="NAME", help="With --from: the arm side's angle.")] = None,
    gear: Annotated[float, typer.Option(help="With --from: turns of the motor per turn of the joint.")] = 1.0,
    rate: Annotated[float | None, typer.Option(help="With --from: samples/s.")] = None,
    png: Annotated[Path | None, made_folder("DIR", "Write the maps as PNG files.")] = None,
    again: AgainOption = False,
    recompute: RecomputeOption = False,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Identify backlash, stiffness and friction of joints with a clamped tool, or from recorded torque and angle.

    `kill -USR1 PID`, which it prints, pauses (the arm holds, limits stay active), `kill -USR2 PID` continues, Ctrl-C
    aborts: all stays, and the same command goes on.  Live, maps are drawn into FILE.raw/maps.html after each cycle.

    Examples: `calibrate joints --config cell.toml --live --joints 1-3 --out joints.h5`, first with `--dry-run`;
    `calibrate joints --from map.csv --angle phi --torque tau --gear 121`
    """
    _refuse_unfit(out, compensate)
    if record is not None:
        _refuse_taken(out, [record, config], again)
        measured = recorded_map(record, (angle, torque, link), gear, rate, WAY_OF[compensate])
        return _finish([measured], None, str(record), _words(str(record)), out, png, json)
    cell = rig_file.load(config, CellConfig, laid_over(settings, {"clamping.live": live}))
    wanted = joint_numbers(joints, arm_with_tool(cell).joints)
    cells = in_poses(cell, pose or [], poses)
    if advise or dry_run:
        return (_advise if advise else _say_steps)(cells, wanted, json)
    if out is None:
        raise ValueError("--out is missing: the model file, beside which recordings are stored")
    writes = _output(out, cell, cells, wanted, Wish(again, recompute, accept or []), [config, poses])
    cells = [writes.config] if len(cells) == 1 else in_poses(writes.config, pose or [], poses)
    found = _measured(writes, cells, wanted, words(json), WAY_OF[compensate], accept or [])
    _finish(*found, str(config or "defaults"), _words(f"{writes.raw.name}/") | writes.provenance, out, png, json)
    writes.finish()


def _refuse_unfit(out: Path | None, compensate: str) -> None:
    if out is not None:
        raw_folder(out)  # refuses what is no name of a model
    if compensate not in WAY_OF:
        raise ValueError(f"--compensate is {compensate!r}, must be one of {', '.join(WAY_OF)}")


def _refuse_taken(out: Path | None, inputs: Sequence[Path | None], again: bool) -> None:
    if out is not None:
        refuse_inputs([out, out.with_suffix(".html")], inputs)
        refuse_taken([out, out.with_suffix(".html")], again)


def _output(
    out: Path,
    cell: CellConfig,
    cells: Sequence[CellConfig],
    joints: tuple[int, ...],
    wish: Wish,
    inputs: Sequence[Path | None],
) -> Output[CellConfig]:
    own, is_whole = cells[0] if len(cells) == 1 else cell, not missing_in(cells, joints, out)
    return output(out, KIND, own, wish, [out.with_suffix(".html")], KEPT, is_whole, inputs)


def _words(source: str) -> dict[str, str]:
    return {"recording": source, "software": software(), "computed": now()}


def _advise(cells: Sequence[CellConfig], joints: tuple[int, ...], json: str | None) -> None:
    advised = advice_table.advice(cells[0], arm_with_tool(cells[0]), joints)
    print_table("where to clamp", advice_table.HEAD, advice_table.rows(advised), words(json))
    write_json(json, {"poses": advice_table.figures(advised)})


def _say_steps(cells: Sequence[CellConfig], joints: tuple[int, ...], _: str | None) -> None:
    steps = [step for each in cells for step in clamp_procedure(each.clamping, arm_with_tool(each), joints).steps()]
    for number, step in enumerate(steps, start=1):
        typer.echo(f"{number:3d}  {step.words}")


def joint_numbers(text: str, most: int) -> tuple[int, ...]:
    """Read "1-3,6" as joints that count from 0, in that order; ValueError for anything else or beyond `most`."""
    found: list[int] = []
    for part in text.split(","):
        match = re.fullmatch(r"\s*(\d+)(?:\s*-\s*(\d+))?\s*", part)
        first, last = (int(match[1]), int(match[2] or match[1])) if match else (0, 0)
        if not 1 <= first <= last <= most:
            raise ValueError(f"joints are {text!r}: {part.strip()!r} must be a number or a range from 1 to {most}")
        found += range(first - 1, last)
    return tuple(dict.fromkeys(found))


def _measured(
    writes: Output[CellConfig],
    cells: Sequence[CellConfig],
    joints: tuple[int, ...],
    stream: TextIO,
    chosen: str,
    accept: Sequence[str],
) -> tuple[list[JointResult], ArmStiffness | str | None]:
    """Measure in every pose; return all results, and what several poses say of the whole arm."""
    arm, several = arm_with_tool(cells[0]), len(cells) > 1
    for each in cells:
        clamp_procedure(each.clamping, arm, joints)  # refuses what does not fit before anything moves
    for note in writes.notes:
        _tell(stream, note)
    _tell(stream, f"pid {os.getpid()}: SIGUSR1 pauses, SIGUSR2 continues, Ctrl-C aborts")
    results, experiments = [], []
    with writes.begun(), requests() as asked:
        desk = Desk(lambda text: _tell(stream, text), Conduct(lambda: asked.stop), lambda: asked.pause)
        for number, each in enumerate(cells, start=1):
            if several:
                _tell(stream, f"pose {number} of {len(cells)}")
            place = writes.part(place_of(writes.raw, number, True).name, each, accept, KEPT) if several else writes.raw
            with raw_run(place, each) as folder:
                recorded, way = measure(each, joints, folder, desk, writes.is_recomputed)
            pose = clamp_procedure(each.clamping, arm, joints).pose
            clamped = Clamped(arm, pose, each.clamping.environment, number if several else 0)
            for joint in joints:
                result = of_recording(recorded[joint], way, joint, clamped, chosen)
                results.append(result)
                experiments.append(experiment(recorded[joint], result, clamped))
    return results, whole_arm(arm, experiments) if several else None


def place_of(folder: Path, number: int, several: bool) -> Path:
    """Return the folder of a pose, counted from 1."""
    return folder / f"pose-{number}" if several else folder


def missing_in(cells: Sequence[CellConfig], joints: tuple[int, ...], out: Path) -> bool:
    """Whether a joint is not recorded yet, in some pose."""
    folder = raw_folder(out)
    places = (place_of(folder, number, len(cells) > 1) for number, _ in enumerate(cells, start=1))
    return any(missing(place, joints) for place in places)


def _tell(stream: TextIO, text: str) -> None:
    stream.write(f"{text}\n")
    stream.flush()


def _finish(
    results: Sequence[JointResult],
    whole: ArmStiffness | str | None,
    source: str,
    about: Mapping[str, str],
    out: Path | None,
    png: Path | None,
    json: str | None,
) -> None:
    stream, report = words(json), joints_report(results, whole, source)
    if out is not None:
        write_joints(out, stiffest(results), about)
        report.write(out.with_suffix(".html"))
    if png is not None:
        report.png(png)
    print_table("joints", HEAD, rows(results), stream)
    if isinstance(whole, str):
        _tell(stream, whole)
    if out is not None:
        stream.write(f"report: {out.with_suffix('.html')}\n")
    write_json(json, figures(results, whole))
