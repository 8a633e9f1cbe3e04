"""The page docs/experiments.md: what each experiment can do, and the test that shows it; from experiments.toml."""

import sys
import tomllib
from pathlib import Path
from typing import Any

from stagectl.experiments.registry import EXPERIMENTS

NAMES = [each.name for each in EXPERIMENTS]
STATED = Path(__file__).with_name("experiments.toml")
ABILITIES = {
    "simulated": "runs without hardware",
    "live": "runs with `--live` on the hardware",
    "log": "`stagectl replay RUN/ --from LOG`: feeds another program's log to its controllers",
    "stop": "Ctrl-C, or STOP under the daemon: it ends safely, and the recording is stored",
    "pause": "under the daemon: it pauses and continues",
    "resume": "`--resume`, or the daemon's option: continues a stopped or killed run",
    "killed": "after `kill -9` the recording is intact and can be reported",
    "replay": "`stagectl replay RUN/`: reproduces the controllers' outputs, bit for bit",
    "what_if": "`stagectl replay RUN/ --set KEY=VALUE`: outputs of other settings for the same sensor signals",
    "report": "`stagectl report RUN/`",
    "export": "`stagectl export RUN/`",
    "daemon": "is a procedure of [`stagectl daemon`](service.md)",
}
HEAD = """# What each experiment can do

Which experiment of `stagectl` supports which operation, each cell with the test that shows it.  Made by `make docs`
from `tests/commands/experiments.toml`; the tests check that every option and every procedure of the daemon is listed.
"""


def stated() -> dict[str, dict[str, dict[str, Any]]]:
    """Return what is stated of each ability of each experiment, or of `[every]`; ValueError where that is nothing."""
    found = tomllib.loads(STATED.read_text(encoding="utf-8"))
    every = found.pop("every")
    known = {name: every | found.get(name, {}) for name in NAMES} | {name: every | found[name] for name in found}
    gaps = [f"[{name}] {each}" for name, cells in known.items() for each in ABILITIES if each not in cells]
    if gaps:
        raise ValueError(f"tests/commands/experiments.toml: missing {', '.join(gaps)}")
    return known


def page() -> str:
    """Return the page."""
    known = stated()
    lines = [HEAD, f"| | {' | '.join(f'`{name}`' for name in NAMES)} |", "|---" * (len(NAMES) + 1) + "|"]
    for ability in ABILITIES:
        cells = (known[each][ability] for each in NAMES)
        lines.append(
            f"| {ability.replace('_', ' ')} | {' | '.join('no' if 'why' in cell else 'yes' for cell in cells)} |"
        )
    lines += ["", *(f"- **{name.replace('_', ' ')}**: {what}." for name, what in ABILITIES.items()), ""]
    for each in EXPERIMENTS:
        lines += [f"## `stagectl {each.name}`: [{each.what}]({each.page})", "", "| | | shown by |", "|---|---|---|"]
        for ability in ABILITIES:
            cell = known[each.name][ability]
            said = f"no: {cell['why']}" if "why" in cell else "; ".join(filter(None, ["yes", cell.get("note", "")]))
            test = f"`{cell['test']}`" if cell.get("test") else ""
            lines.append(f"| {ability.replace('_', ' ')} | {said} | {test} |")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    sys.stdout.write(page())
