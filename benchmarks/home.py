"""What the simulators of this project give with default settings, beside what they gave when it was last kept.

`python -m benchmarks.home [--write]`, minutes; exit status 1 where a figure is worse than the kept one by more than
5 %.  `--write` keeps today's, in docs/home.json, and writes docs/home.md: a figure that grew worse is then in the
change for all to see.
"""

import contextlib
import io
import json
import math
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.page_table import DOCS, FLAG, table
from rigkit import atomic
from rigkit.json_text import json_text
from rigkit.provenance import now, software
from rigkit.study.json_path import value_at
from rigkit.study.programs import call

KEPT, PAGE = DOCS / "home.json", DOCS / "home.md"
ALLOWED = 1.05
"""How much larger a figure may be than the kept one."""
COMMANDS = (
    "stagectl example-pocket --json POCKET.json",
    "stagectl plan POCKET.json --planner exact --json exact.json",
    "stagectl plan POCKET.json --planner uncertain --untrained --pockets 3 --json learned.json",
    "stagectl midrange --scenario table-3.1 --json midranging.json",
    "calibrate vibrator --out model.h5 --json model.json",
    "vibractl run --model model.h5 --reference chirp:40:90:5 --shots 30 --out RUN --json run.json",
    "stagectl cell --setup C --out TOROID --json toroid.json",
)


@dataclass(frozen=True)
class Figure:
    """A figure that is positive, and better when it is smaller, or, of a gain, larger.

    Parameters
    ----------
    title, unit : str
    file, path : str
        Which command's JSON has it, and where.
    is_level : bool
        In dB: as an amplitude it is compared.
    is_gain : bool
        Better when it is larger.
    """

    title: str
    unit: str
    file: str
    path: str
    is_level: bool = False
    is_gain: bool = False

    @property
    def key(self) -> str:
        """What it is kept under."""
        return f"{self.file}: {self.path}"

    def ratio(self, value: float, before: float) -> float:
        """Return how many times as bad a value is as the one before; 1 where both are zero."""
        if self.is_gain:
            value, before = before, value
        if self.is_level:
            return math.pow(10.0, (value - before) / 20.0)
        return value / before if before else 1.0 if value == 0.0 else math.inf


FIGURES = (
    Figure("`make run`: first shot that meets the objective, counted from 0", "", "run.json", "objective_met_shot"),
    Figure("`make run`: worst bin of the last shot over the limit", "dB", "run.json", "worst_line_db", is_level=True),
    Figure("`make run`: IAE, first shot over last, side 1", "", "run.json", "iae_ratio[0]", is_gain=True),
    Figure("`make run`: IAE, first shot over last, side 2", "", "run.json", "iae_ratio[1]", is_gain=True),
    Figure("`make run`: median relative deviation of G", "", "model.json", "median_relative_deviation"),
    Figure("Table 3.1, r = 1.5: IAE of AIMC", "mm s", "midranging.json", "setups[0].aimc_iae"),
    Figure("Table 3.1, r = 5: IAE of AIMC", "mm s", "midranging.json", "setups[1].aimc_iae"),
    Figure("Table 3.1, r = 5 with noise: IAE of AIMC", "mm s", "midranging.json", "setups[2].aimc_iae"),
    Figure("toroid, setup C: mean distance from the circle", "m", "toroid.json", "circle_mae"),
    Figure("toroid, setup C: roughness", "m", "toroid.json", "roughness"),
    Figure("pocket of chapter 7: the exact plan", "s", "exact.json", "pockets[0].total"),
    Figure("pocket of chapter 7: third pocket, rates learned", "s", "learned.json", "pockets[2].total"),
)
_HEAD = """\
# Home: the simulators' own figures

The table has figures of this project's own simulators with default settings. They do not validate the programs for
other plants; the [populations](populations.md) do. They detect regressions: `python -m benchmarks.home` computes them
again and fails where one is worse by more than 5 %. `make bench` stores the new ones.
"""


def measured() -> dict[str, float]:
    """Run the commands in a folder of their own, and return the figures by their keys."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for command in COMMANDS:
            sys.stderr.write(f"{command}\n")
            with contextlib.redirect_stdout(io.StringIO()):
                status = call(command.split())
            if status:
                raise RuntimeError(f"{command}: status {status}")
        told = {file: json.loads(Path(file).read_text()) for file in {each.file for each in FIGURES}}
    return {each.key: float(value_at(told[each.file], each.path)) for each in FIGURES}


def page(kept: Mapping[str, Any]) -> str:
    """Return the page that belongs to kept figures."""
    rows = [[each.title, f"{kept['figures'][each.key]:.4g}", each.unit or "-"] for each in FIGURES]
    origin = f"{kept['time'][:10]}; {kept['software']}; `docs/home.json`."
    return f"{_HEAD}\n{table(['figure', 'value', 'unit'], rows)}\n\n{origin}\n"


def worse(before: Mapping[str, float], today: Mapping[str, float]) -> list[str]:
    """Return a line for each figure that is worse than the one before by more than is allowed."""
    pairs = [(each, each.ratio(today[each.key], before[each.key])) for each in FIGURES if each.key in before]
    return [
        f"{each.title}: {today[each.key]:.4g}, was {before[each.key]:.4g}: {100 * (ratio - 1):.1f} % worse"
        for each, ratio in pairs
        if ratio > ALLOWED
    ]


def main() -> int:
    """Measure, compare, and keep where that is asked for."""
    before = json.loads(KEPT.read_text())["figures"] if KEPT.exists() else {}
    today = measured()
    kept = {"time": now(), "software": software(), "figures": today}
    print(page(kept))
    lines = worse(before, today)
    print("\n".join(lines) or f"nothing is worse than in {KEPT.name}")
    if FLAG in sys.argv:
        atomic.write(KEPT, f"{json_text(kept, indent=2)}\n")
        atomic.write(PAGE, page(kept))
        return 0
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
