"""The command `stagectl step`."""

from typing import Annotated

import typer

from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, PngOption, SetOption, laid_over, print_table, words, write_json
from rigkit.config_fault import checked
from rigkit.experiment.command import CommandLine, RunOption, refuse_png_alone
from stagectl.experiments.midranging.command import LiveOption
from stagectl.experiments.step.experiment import STEPS, Steps
from stagectl.experiments.step.report import HEAD, rows, unlike
from stagectl.experiments.step.response import Wanted
from stagectl.robot.config import CellConfig

DEFAULT = Wanted()


def step(
    of: Annotated[str, typer.Option(metavar="both|robot|stage", help="Which manipulator.")] = DEFAULT.of,
    kind: Annotated[str, typer.Option(metavar="step|multisine", help="What is asked.")] = DEFAULT.kind,
    size: Annotated[float, typer.Option(metavar="M", help="Of the steps, or peak of the multisine.")] = DEFAULT.size,
    period: Annotated[float, typer.Option(metavar="S", help="Steps up and down, or multisine.")] = DEFAULT.period,
    repeats: Annotated[int, typer.Option(metavar="N", help="Periods of each manipulator.")] = DEFAULT.repeats,
    highest: Annotated[float, typer.Option(metavar="HZ", help="Line of the multisine.")] = DEFAULT.highest,
    config: ConfigOption = None,
    live: LiveOption = False,
    out: RunOption = None,
    png: PngOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Read delay, gain and bandwidth of robot and stage off a step or a multisine, for mid-ranging and dead times.

    Example: `stagectl step --config cell.toml --of both --kind multisine --out STEPS/`
    """
    cell = rig_file.load(config, CellConfig, laid_over(settings, {"midranging.session.live": live}))
    refuse_png_alone(png, out)
    given = {"of": of, "kind": kind, "size": size, "period": period, "repeats": repeats, "highest": highest}
    made = Steps(cell, checked(Wanted, given, "what is asked"))
    line = CommandLine("steps", made.is_live, out, png, json)
    reasons, found = line.carry_out(STEPS, cell, made)
    print_table(f"{made.wanted.kind} responses", HEAD, rows(found), words(json))
    for sentence in unlike(found):
        words(json).write(f"{sentence}\n")
    write_json(json, found)
    line.end(reasons)
