"""`vibractl report`."""

from rigkit.command import JsonOption, PngOption, RunArgument, words, write_json
from rigkit.run_origin import say_at_work
from vibractl.report import run_report
from vibractl.run_setup import say_changed, settings_of


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
