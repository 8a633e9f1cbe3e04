"""`vibractl replay`."""

import sys
import time
from pathlib import Path
from typing import Annotated

import typer

from rigkit.command import JsonOption, RunArgument, SetOption, print_table, words, write_json
from rigkit.progress import progress
from rigkit.run_origin import say_at_work
from rigkit.stop import Stopped, stoppable
from vibractl.replay import Replayed, replay
from vibractl.run_setup import is_imported, say_changed, settings_of, setup_of, shot_files
from vibractl.setup import Setup


def replay_command(
    path: RunArgument,
    shot: Annotated[int | None, typer.Option(help="Report only this shot.")] = None,
    model: Annotated[Path | None, typer.Option(metavar="FILE", help="Another model, to compare.")] = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Recompute every drive of a run from its recorded responses; status 1 if one differs from the recorded one.

    For an imported run: the next drive of the law after each recorded shot; it needs a model.

    Example: `vibractl replay RUN/`; with other settings: `vibractl replay RUN/ --set learning.gains=[0.5]`
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
