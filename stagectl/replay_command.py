"""`stagectl replay`."""

import sys
from collections.abc import Iterator

import typer

from rigkit.command import JsonOption, RunArgument, print_table, words, write_json
from rigkit.experiment.replayed import Replayed
from rigkit.run_origin import say_at_work
from stagectl.changed import say_changed
from stagectl.kinds_of_run import replayed


def replay_command(
    path: RunArgument,
    json: JsonOption = None,
) -> None:
    """Make every output of a run again from its recorded sensors; status 1 if one differs from the recorded one.

    Example: `stagectl replay RUN/`
    """
    say_changed(path)
    say_at_work(path)
    done = _collected(replayed(path))
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
    if differ:
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
