"""Histograms of what each family of a population draws: `python -m benchmarks.populations [KIND ...]`.

One picture a family goes into docs/images/populations/, of the first seeds of that family.
"""

import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.page_table import DOCS
from firmware_sim.population.draw import Draw, Population
from firmware_sim.population.kinds import KINDS, population
from rigkit.figure_style import styled

SEEDS = 100
COLUMNS, CELL = 4, (2.6, 1.7)
"""Histograms side by side, and inches of one."""
BINS = 20
RARE = 0.15
"""1: a quantity that fewer machines have is left out."""
WIDE = 30.0
"""1: from this ratio of the 95th to the 5th hundredth on, the axis is logarithmic."""


def main() -> None:
    """Draw the pictures of the kinds that are named, or of all."""
    folder = DOCS / "images" / "populations"
    folder.mkdir(parents=True, exist_ok=True)
    for kind in sys.argv[1:] or KINDS:
        kinds = population(kind)
        for family in (*kinds.families, *kinds.named):
            picture(kinds, family, folder / f"{kind}-{family}.png")


def picture(kinds: Population, family: str, file: Path) -> None:
    """Draw a family's picture, if it can be drawn here."""
    try:
        draws = [kinds.draw(seed, family) for seed in range(SEEDS)]
    except ValueError as fault:
        print(f"{file.name}: {fault}")
        return
    columns = {name: values for name, values in quantities(draws).items() if is_shown(values)}
    figure(f"{kinds.kind} of family {family}, {SEEDS} seeds", columns).savefig(file, dpi=80)
    print(f"{file.name}: {len(columns)} quantities of {SEEDS} machines")


def is_shown(values: list[Any]) -> bool:
    """Whether a quantity is drawn: machines differ by it, and many have it."""
    return len(values) >= RARE * SEEDS and len(set(values)) > 1


def quantities(draws: list[Draw]) -> dict[str, list[Any]]:
    """Return all values of each quantity by name and unit; those of a tuple one by one."""
    found: dict[str, list[Any]] = {}
    for draw in draws:
        for each in draw.quantities:
            name = f"{each.name}, {each.unit}" if each.unit not in ("", "1") else each.name
            found.setdefault(name, []).extend(each.value if isinstance(each.value, tuple) else [each.value])
    return {name: list(parts) for name, values in found.items() for name, parts in split(name, values)}


def split(name: str, values: list[Any]) -> Iterator[tuple[str, list[Any]]]:
    """Part numbers from words; what names a signal is left out."""
    numbers = [value for value in values if isinstance(value, int | float | np.number)]
    words = [value for value in values if isinstance(value, str) and ":" not in value]
    if numbers:
        yield name, numbers
    if words:
        yield f"{name} ", words


@styled()
def figure(title: str, columns: dict[str, list[Any]]) -> Figure:
    """Draw a histogram of each quantity."""
    rows = -(-len(columns) // COLUMNS)
    drawn = Figure(figsize=(COLUMNS * CELL[0], rows * CELL[1] + 0.4))
    drawn.suptitle(title)
    for place, (name, values) in enumerate(columns.items()):
        axes = drawn.add_subplot(rows, COLUMNS, place + 1)
        axes.set_title(textwrap.fill(name, 26), fontsize=8)
        axes.tick_params(labelsize=7)
        if isinstance(values[0], str):
            words = sorted(set(values))
            axes.barh(words, [values.count(word) for word in words])
            continue
        numbers = np.array(values, float)
        low, high = np.percentile(numbers, [5, 95])
        if low > 0 and high / low > WIDE:
            axes.set_xscale("log")
            axes.minorticks_off()
            axes.hist(numbers, np.geomspace(numbers.min(), numbers.max(), BINS))
        elif set(values) <= set(range(12)):
            axes.bar(*np.unique(numbers, return_counts=True))
        else:
            axes.hist(numbers, BINS)
    return drawn


if __name__ == "__main__":
    main()
