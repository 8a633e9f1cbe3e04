"""`stagectl replay`."""

import sys
from collections.abc import Iterator

import typer

from rigkit.command import JsonOption, RunArgument, SetOption, print_table, words, write_json
from rigkit.experiment.replayed import Replayed
from rigkit.run_origin import say_at_work
from stagectl.changed import say_changed
from stagectl.kinds_of_run import replayed


def replay_command(
    path: RunArgument,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Make every output of a run again from its recorded sensors; status 1 if one differs from the recorded one.

    With --set it tells what would have been made of the sensors as they were, and by how much that differs.

    Examples: `stagectl replay RUN/`, `stagectl replay RUN/ --set midranging.valve.feed=1.0`
    """
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


def _collected(again: Iterator[Replayed]) -> list[Replayed]:
    """Return what was made again; say beforehand how long that takes, and then each recording that is done."""
    sys.stderr.write("making every recording again takes about as long as a simulation of the run\n")
    done: list[Replayed] = []
    for each in again:
        if not done or done[-1].recording != each.recording:
            sys.stderr.write(f"made again: {each.recording}\n")
        done.append(each)
    return done
