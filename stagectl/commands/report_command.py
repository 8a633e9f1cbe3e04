"""`stagectl report`."""

from rigkit.command import JsonOption, PngOption, RunArgument, words, write_json
from rigkit.run_folder import make_whole
from rigkit.run_origin import say_at_work
from stagectl.commands.changed import say_changed
from stagectl.commands.kinds_of_run import reported


def report_command(
    path: RunArgument,
    png: PngOption = None,
    json: JsonOption = None,
) -> None:
    """Draw the report of a run again.

    Example: `stagectl report RUN/ --png figures/`
    """
    say_changed(path)
    make_whole(path)
    say_at_work(path)
    figures = reported(path, png)
    print(f"report: {path / 'report.html'}", file=words(json))
    write_json(json, figures)
