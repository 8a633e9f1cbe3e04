"""The command `firmware-sim draw`: a machine of a population, and the rig file that fits it."""

from pathlib import Path
from typing import Annotated, Any

import typer

from firmware_sim.population.draw import Draw, Quantity
from firmware_sim.population.kinds import KINDS, population
from firmware_sim.population.signal_config import SignalConfig
from rigkit.command import JsonOption, SetOption, print_table, words, write_json
from rigkit.common_options import one_of
from rigkit.config import Section, load
from rigkit.toml_text import value_text
from stagectl.config import StageConfig
from stagectl.robot.config import CellConfig
from vibractl.config import RigConfig

MODELS: dict[str, type[Section]] = {
    "vibrator": RigConfig,
    "stage": StageConfig,
    "pair": CellConfig,
    "cell": CellConfig,
    "signal": SignalConfig,
}
"""What a rig file of each kind holds."""


def draw_command(
    kind: Annotated[
        str, typer.Argument(metavar="KIND", help=f"One of {', '.join(KINDS)}.", autocompletion=one_of(KINDS))
    ],
    seed: Annotated[int, typer.Option(help="Seed of the plant, >= 0.")],
    family: Annotated[str, typer.Option(help="Family of plants; default: chosen by the seed.")] = "",
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write a complete rig file; of a signal, its folder."),
    ] = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Draw a plant by its seed: its parameters, and the keys of a rig file that fit it.

    A seed is the same plant on every computer.  --set changes keys of the rig file, not the plant.  Of a signal for
    identification --out is a folder for record.csv and truth.json, or a CSV or WAV file.

    Example: `firmware-sim draw vibrator --seed 7 --out seven.toml`

    Example: `firmware-sim draw signal --seed 7 --out SEVEN/`
    """
    kinds = population(kind)
    drawn = kinds.draw(seed, family)
    config = load(None, MODELS[kind], [*_laid_over(drawn), *(settings or [])])
    if out is not None:
        kinds.write(drawn, config, out)
    write_json(json, figures(drawn))
    _show(drawn, words(json))


def figures(drawn: Draw) -> dict[str, Any]:
    """Return a draw as plain values for JSON."""
    return {
        "kind": drawn.kind,
        "family": drawn.family,
        "seed": drawn.seed,
        "drawn": {each.name: {"value": each.value, "unit": each.unit} for each in drawn.quantities},
        "rig": dict(drawn.keys),
    }


def _laid_over(drawn: Draw) -> list[str]:
    return [f"{key}={value_text(value)}" for key, value in drawn.keys.items()]


def _show(drawn: Draw, stream: Any) -> None:
    title = f"{drawn.kind} {drawn.seed}, family {drawn.family}"
    print_table(title, ["drawn", "value", "unit"], [_row(each) for each in drawn.quantities], stream)
    print_table(
        "keys that fit it", ["key", "value"], [[key, value_text(value)] for key, value in drawn.keys.items()], stream
    )


def _row(each: Quantity) -> list[str]:
    values = each.value if isinstance(each.value, tuple) else (each.value,)
    text = ", ".join(f"{value:.4g}" if isinstance(value, float) else str(value) for value in values)
    return [each.name, text, each.unit]
