"""The command `calibrate joints`."""

import re
from pathlib import Path
from typing import Annotated, TextIO

import typer

from calibration.foreign_record import read_channels
from calibration.joint_clamping.config import JointsConfig, clamped_arm, procedure
from calibration.joint_clamping.joints_file import write_joints
from calibration.joint_clamping.measurement import measure
from calibration.joint_clamping.report import HEAD, figures, joints_report, rows
from calibration.joint_clamping.results import JointResult, of_map, of_recording
from calibration.joint_clamping.torque_map import TorqueMap
from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, print_table, words, write_json
from rigkit.provenance import now, software
from rigkit.stop import stoppable

ANGLES = {"rad": 1.0, "mrad": 1e-3, "urad": 1e-6, "deg": 0.017453292519943295, "1": 1.0}
TORQUES = {"N m": 1.0, "Nm": 1.0, "N*m": 1.0, "mN m": 1e-3, "1": 1.0}


def joints_command(
    config: ConfigOption = None,
    record: Annotated[Path | None, typer.Option("--from", metavar="MAP", help="Recorded: CSV, WAV or HDF5.")] = None,
    joints: Annotated[str, typer.Option(metavar="1-6", help="Which joints: numbers and ranges.")] = "1-6",
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="Model file; the report goes beside it.")] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Print every motion, and make none.")] = False,
    angle: Annotated[str, typer.Option(metavar="NAME", help="With --from: channel of the motor's angle.")] = "angle",
    torque: Annotated[str, typer.Option(metavar="NAME", help="With --from: channel of its torque.")] = "torque",
    link: Annotated[str | None, typer.Option(metavar="NAME", help="With --from: the arm side's angle.")] = None,
    gear: Annotated[float, typer.Option(help="With --from: turns of the motor per turn of the joint.")] = 1.0,
    rate: Annotated[float | None, typer.Option(help="With --from: samples a second.")] = None,
    png: Annotated[Path | None, typer.Option(metavar="DIR", help="Write the maps as PNG files.")] = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Find backlash, stiffness and friction of joints whose tool is clamped, or from a recorded torque and angle.

    Examples: `calibrate joints --config cell.toml --joints 1-6 --dry-run`,
    `calibrate joints --from map.csv --angle phi --torque tau --gear 121`
    """
    if out is not None and (out.suffix != ".h5" or not out.parent.is_dir()):
        raise ValueError(f"--out {out}: must end in '.h5' and lie in a folder that is there")
    if record is not None:
        results = [_recorded(record, (angle, torque, link), gear, rate)]
    else:
        rig = rig_file.load(config, JointsConfig, settings or [])
        wanted = joint_numbers(joints, clamped_arm(rig).joints)
        if dry_run:
            for number, step in enumerate(procedure(rig, wanted).steps(), start=1):
                typer.echo(f"{number:3d}  {step.words}")
            return
        results = _measured(rig, wanted, out, json)
    _finish(results, str(record or config or "defaults"), out, png, json)


def joint_numbers(text: str, most: int) -> tuple[int, ...]:
    """Read "1-3,6" as joints that count from 0, in that order; ValueError for anything else or beyond `most`."""
    found: list[int] = []
    for part in text.split(","):
        match = re.fullmatch(r"\s*(\d+)(?:\s*-\s*(\d+))?\s*", part)
        first, last = (int(match[1]), int(match[2] or match[1])) if match else (0, 0)
        if not 1 <= first <= last <= most:
            raise ValueError(f"--joints {text!r}: {part.strip()!r} must be a number or a range from 1 to {most}")
        found += range(first - 1, last)
    return tuple(dict.fromkeys(found))


def _recorded(path: Path, names: tuple[str, str, str | None], gear: float, rate: float | None) -> JointResult:
    """Read a map that somebody else recorded."""
    if not (abs(gear) > 0 and abs(gear) < float("inf")):
        raise ValueError(f"--gear is {gear}, must be finite and not 0")
    channels = [name for name in names if name is not None]
    found = read_channels(path, channels, rate)
    data = found.data.astype(float)
    kinds = (ANGLES, TORQUES, ANGLES)[: len(channels)]
    scales = [_scale(*each) for each in zip(channels, found.units, kinds, strict=True)]
    joint = TorqueMap(scales[0] * data[:, 0] / gear, scales[1] * data[:, 1] * gear, found.rate)
    return of_map(joint, scales[2] * data[:, 2] if len(channels) == 3 else None)


def _scale(name: str, unit: str, known: dict[str, float]) -> float:
    if unit not in known:
        raise ValueError(f"channel {name}: the unit is {unit!r}, must be one of {', '.join(known)}")
    return known[unit]


def _measured(rig: JointsConfig, joints: tuple[int, ...], out: Path | None, json: str | None) -> list[JointResult]:
    if out is None:
        raise ValueError("--out is missing: recordings are kept beside the model file")
    stream = words(json)
    with stoppable() as stop:
        recorded = measure(rig, joints, out.with_suffix(".raw"), lambda text: _tell(stream, text), lambda: stop.made)
    made = procedure(rig, joints)
    return [of_recording(recorded[joint], joint, made.arm, made.pose) for joint in joints]


def _tell(stream: TextIO, text: str) -> None:
    stream.write(f"{text}\n")
    stream.flush()


def _finish(results: list[JointResult], source: str, out: Path | None, png: Path | None, json: str | None) -> None:
    stream, report = words(json), joints_report(results, source)
    if out is not None:
        write_joints(out, results, {"recording": source, "made": now(), "software": software()})
        report.write(out.with_suffix(".html"))
    if png is not None:
        report.png(png)
    print_table("joints", HEAD, rows(results), stream)
    if out is not None:
        stream.write(f"report: {out.with_suffix('.html')}\n")
    write_json(json, figures(results))
