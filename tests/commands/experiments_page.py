"""The page docs/experiments.md: what each experiment can do, and the test that shows it; from experiments.toml."""

import sys
import tomllib
from pathlib import Path
from typing import Any

STATED = Path(__file__).with_name("experiments.toml")
EXPERIMENTS = {
    "run": ("`stagectl run`", "[the piezo stage](stage.md)"),
    "midrange": ("`stagectl midrange`", "[a position shared by robot and stage](midranging.md)"),
    "step": ("`stagectl step`", "[steps on robot and stage](midranging.md#what-the-pair-is)"),
    "cell": ("`stagectl cell`", "[the toroid in steel](cell.md)"),
    "ilc": ("`stagectl ilc`", "[learning to mill](ilc.md)"),
    "force": ("`stagectl force`", "[milling by force](force-control.md)"),
}
ABILITIES = {
    "simulated": "runs without hardware",
    "live": "runs with `--live`, over the machine's wires",
    "log": "`stagectl replay RUN/ --from LOG`: another program's log goes through its controllers",
    "stop": "Ctrl-C, or STOP under the daemon: it ends safely, and what is recorded is kept",
    "pause": "under the daemon: it waits, and goes on",
    "resume": "`--resume`, or the daemon's option: it goes on with a run that was stopped or killed",
    "killed": "after `kill -9` what was recorded is there, and is reported",
    "replay": "`stagectl replay RUN/`: what controllers made comes out again, bit for bit",
    "what_if": "`stagectl replay RUN/ --set KEY=VALUE`: what would have been made of the sensors",
    "report": "`stagectl report RUN/`",
    "export": "`stagectl export RUN/`",
    "daemon": "is a procedure of [`stagectl daemon`](service.md)",
}
HEAD = """# What each experiment can do

Made by `make docs` from `tests/commands/experiments.toml`, each cell with the test that shows it. The suite refuses a
cell whose test is not there, and an option or a procedure of the daemon that this page does not know.
"""


def stated() -> dict[str, dict[str, dict[str, Any]]]:
    """Return what is stated of each ability of each experiment."""
    return tomllib.loads(STATED.read_text(encoding="utf-8"))


def page() -> str:
    """Return the page."""
    known = stated()
    lines = [HEAD, f"| | {' | '.join(f'`{name}`' for name in EXPERIMENTS)} |", "|---" * (len(EXPERIMENTS) + 1) + "|"]
    for ability in ABILITIES:
        cells = (known[each][ability] for each in EXPERIMENTS)
        lines.append(
            f"| {ability.replace('_', ' ')} | {' | '.join('no' if 'why' in cell else 'yes' for cell in cells)} |"
        )
    lines += ["", *(f"- **{name.replace('_', ' ')}**: {what}." for name, what in ABILITIES.items()), ""]
    for name, (command, what) in EXPERIMENTS.items():
        lines += [f"## {command}: {what}", "", "| | | shown by |", "|---|---|---|"]
        for ability in ABILITIES:
            cell = known[name][ability]
            said = f"no: {cell['why']}" if "why" in cell else "; ".join(filter(None, ["yes", cell.get("note", "")]))
            test = f"`{cell['test']}`" if cell.get("test") else ""
            lines.append(f"| {ability.replace('_', ' ')} | {said} | {test} |")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    sys.stdout.write(page())
