"""The commands of `vibractl`."""

import sys
import time
import tomllib
from pathlib import Path
from typing import Annotated

import typer

from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import (
    ConfigOption,
    JsonOption,
    PngOption,
    SetOption,
    print_table,
    words,
    write_json,
)
from rigkit.progress import progress
from rigkit.retention_command import prune_command
from rigkit.run_folder import RunFolder, read_quality
from rigkit.run_origin import say_at_work
from rigkit.stop import Stopped, stoppable
from vibractl.application import app
from vibractl.audio_stream import AudioError
from vibractl.config import RigConfig
from vibractl.doctor.command import doctor_command
from vibractl.export.command import export_command
from vibractl.fft_command import plan_command
from vibractl.foreign.import_command import import_command
from vibractl.foreign.judge_command import judge_command
from vibractl.foreign.step_command import step_command
from vibractl.library.command import LibraryOption, TagOption, chosen_entry, library_app
from vibractl.predict.command import predict_command
from vibractl.presets import PRESETS
from vibractl.quality import Marks
from vibractl.quality_table import prefix_of
from vibractl.replay import Replayed, replay
from vibractl.report import run_report
from vibractl.run_setup import create, is_imported, resumed_setup, say_changed, settings_of, setup_of, shot_files
from vibractl.session import Session
from vibractl.setup import Setup

app.command("export")(export_command)
app.command("prune")(prune_command)
app.command("doctor")(doctor_command)
app.command("predict")(predict_command)
app.command("plan-ffts")(plan_command)
app.command("step")(step_command)
app.command("judge")(judge_command)
app.command("import")(import_command)
app.add_typer(library_app, name="library")

RunArgument = Annotated[Path, typer.Argument(metavar="RUN/", help="Folder of a run.")]


@app.command("example-config")
def example_config(
    preset: Annotated[str | None, typer.Option(metavar="underwater", help="A short one for a purpose.")] = None,
    json: JsonOption = None,
) -> None:
    """Print a complete rig file for the simulator: every key with its unit, range and default.

    Example: `vibractl example-config > rig.toml`; in water, before a hydrophone: `--preset underwater`
    """
    if preset is not None and preset not in PRESETS:
        raise ValueError(f"--preset is {preset!r}, must be {' or '.join(PRESETS)}")
    text = rig_file.example(RigConfig) if preset is None else PRESETS[preset]
    words(json).write(text)
    write_json(json, tomllib.loads(text))


@app.command("run")
def run_command(
    out: Annotated[Path | None, typer.Option(metavar="RUN/", help="Folder to make for a new run.")] = None,
    model: Annotated[Path | None, typer.Option(metavar="FILE", help="Model file from `calibrate vibrator`.")] = None,
    config: ConfigOption = None,
    reference: Annotated[
        str | None, typer.Option(help="chirp:F0:F1:SECONDS, sine:F0:SECONDS, or a WAV or CSV file.")
    ] = None,
    shots: Annotated[int | None, typer.Option(min=1, help="Shots in all.")] = None,
    side: Annotated[int | None, typer.Option(help="Drive and control this side only; 0 for all.")] = None,
    watch: Annotated[bool, typer.Option("--watch", help="Reidentify bands that diverge, while it goes on.")] = False,
    law: Annotated[str | None, typer.Option(help="kalman, or thesis for the text's own law.")] = None,
    seed: Annotated[int | None, typer.Option(help="Which simulated vibrator.")] = None,
    warm: Annotated[
        str | None, typer.Option(metavar="NAME", help="Start from this entry of the library, or from the nearest.")
    ] = None,
    tag: TagOption = None,
    library: LibraryOption = None,
    resume: Annotated[Path | None, typer.Option(metavar="RUN/", help="Go on with a run that stopped.")] = None,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Learn a reference shot by shot, and end with a report.

    Example: `vibractl run --config rig.toml --model model.h5 --reference chirp:40:90:5 --shots 30 --out RUN/`
    """
    flags = {"reference.signal": reference, "learning.side": side, "learning.law": law, "simulator.options.seed": seed}
    flags |= {"watch.on": "true" if watch else None, "session.shots": shots}
    laid_over = [*(settings or []), *(f"{key}={value}" for key, value in flags.items() if value is not None)]
    if resume is not None:
        paths = {"--out": out, "--model": model, "--config": config, "--library": library}
        given = [name for name, value in {**paths, "--warm": warm, "--tag": tag}.items() if value]
        if given or [text for text in laid_over if not text.startswith("session.shots=")]:
            raise ValueError(f"--resume {resume} has the run's own settings; only --shots and --accept may go with it")
        _go_on(resume, shots, accept or [], json)
        return
    if out is None or model is None:
        raise ValueError("a new run needs --model FILE and --out RUN/")
    settled = rig_file.load(config, RigConfig, laid_over)
    entry = chosen_entry(warm, settled, tag, library, accept or [])
    folder, made = create(out, settled, model, entry, accept=accept or [])
    with folder:
        _begin(Session(folder, made), json)


def _begin(session: Session, json: str | None) -> None:
    """Learn from the first shot on; a run that comes to nothing leaves no folder."""
    try:
        _learn(session, session.config.session.shots, json)
    except (AudioError, ValueError, OSError):
        if session.untouched:
            session.folder.withdraw()
        raise


def _go_on(path: Path, shots: int | None, accept: list[str], json: str | None) -> None:
    with RunFolder.open(path) as folder:
        made = resumed_setup(folder, accept)
        session = Session(folder, made, accept=accept)
        _learn(session, made.config.session.shots if shots is None else shots, json)


def _learn(session: Session, shots: int, json: str | None) -> None:
    path = session.folder.path
    sys.stderr.write(session.note)
    with stoppable() as stop, progress("learning", shots, start=session.done) as meter:

        def tell(shot: int, marks: Marks) -> None:
            meter.show(shot + 1, f"shot {shot}: objective {marks.reason}")

        if session.done < shots:
            meter.say(f"learning: {shots - session.done} shots of {session.seconds:.1f} s; the stream is opened")
        session.run(shots, tell, lambda: stop.made)
    figures = session.summary()
    if stop.made and session.done < shots:
        raise Stopped(f"{session.done} of {shots} shots are recorded; go on with: vibractl run --resume {path}")
    run_report(path)
    _print_shots(path, json)
    met = figures["objective_met_shot"]
    verdict = f"objective met from shot {met} on" if met is not None else "objective not met"
    print(f"{verdict}; report: {path / 'report.html'}", file=words(json))
    write_json(json, figures)


def _print_shots(path: Path, json: str | None) -> None:
    rows = read_quality(path)
    prefix = prefix_of(rows)
    sides = sum(key.startswith(f"{prefix}iae_") for key in rows[0])
    head, keys = ["shot", "gain", "verdict"], ["shot", "gain", "verdict"]
    for side in range(1, sides + 1):
        head += [f"worst line {side}, dB", "at, Hz", f"IAE {side}", f"error {side}, dB"]
        keys += [f"{prefix}{name}_{side}" for name in ("worst_line_db", "worst_line_hz", "iae", "error_db")]
    body = [[_short(row[key]) for key in keys] for row in rows]
    print_table(f"{path}: worst line against the limit, negative is good", head, body, words(json))


def _short(cell: str) -> str:
    try:
        return cell if cell.isdigit() else f"{float(cell):.4g}"
    except ValueError:
        return cell


@app.command("replay")
def replay_command(
    path: RunArgument,
    shot: Annotated[int | None, typer.Option(help="Report this shot alone.")] = None,
    model: Annotated[Path | None, typer.Option(metavar="FILE", help="Another model: what would it have done?")] = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Rebuild every drive of a run from its recorded responses; status 1 if one differs from the recorded one.

    Of an imported run: what the law would have played next, each time after what was played; it needs a model.

    Example: `vibractl replay RUN/`; what would have been: `vibractl replay RUN/ --set learning.gains=[0.5]`
    """
    settings_of(path)
    say_changed(path)
    say_at_work(path)
    made = setup_of(path, tuple(settings or ()), model)
    if made.plans.note:
        sys.stderr.write(f"{made.plans.note}\n")
    done, speed = _replayed(path, made, shot)
    found = [each for each in done if shot in (None, each.shot)]
    rows = [
        [str(each.shot), "yes" if each.identical else "no", f"{each.difference:.3g}", f"{each.difference_db:.1f}"]
        for each in found
    ]
    if not rows:
        raise ValueError(f"{path}: no shot {shot} is recorded")
    differ = sum(row[1] == "no" for row in rows)
    head = ["shot", "bit for bit", "largest difference, V", "rms difference, dB re drive"]
    print_table(f"{path}: drives rebuilt from the recorded responses", head, rows, words(json))
    differences = {
        "difference_v": [each.difference for each in found],
        "difference_db": [each.difference_db for each in found],
    }
    write_json(json, {"shots": len(rows), "differing": differ, "times_real_time": speed, **differences})
    asked_for_other = model is not None or settings or is_imported(path)
    if differ and not asked_for_other:
        raise typer.Exit(1)


def _replayed(path: Path, made: Setup, last: int | None) -> tuple[list[Replayed], float]:
    """Replay a run up to its shot `last`, or all of it; return that and how many times as fast as it was played."""
    total = len(shot_files(path)) if last is None else last + 1
    done: list[Replayed] = []
    begun, speed = time.monotonic(), 0.0
    with stoppable() as stop, progress("replaying", total) as meter:
        for each in replay(path, made):
            done.append(each)
            speed = sum(shot.seconds for shot in done) / max(time.monotonic() - begun, 1e-9)
            meter.show(each.shot + 1, f"shot {each.shot}: {speed:.0f} times real time")
            if stop.made or each.shot == last:
                break
    if stop.made and len(done) < total:
        raise Stopped(f"{len(done)} of {total} shots are replayed; begin again with: vibractl replay {path}")
    return done, speed


@app.command("report")
def report_command(
    path: RunArgument,
    png: PngOption = None,
    json: JsonOption = None,
) -> None:
    """Draw the report of a run again.

    Example: `vibractl report RUN/ --png figures/`
    """
    settings_of(path)
    say_changed(path)
    say_at_work(path)
    figures = run_report(path, png)
    print(f"report: {path / 'report.html'}, of {figures['shots']} shots", file=words(json))
    write_json(json, figures)
