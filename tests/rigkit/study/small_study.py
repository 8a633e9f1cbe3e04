"""A study whose tasks are quick, for the tests: a planner learns a pocket, and how well depends on its seed."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from rigkit.provenance import software
from rigkit.study import programs
from rigkit.study.outcome import Outcome
from rigkit.study.plan import Plan, read_plan
from rigkit.study.task import Task
from stagectl.planning.example_pocket import EXAMPLE_POCKET

STUDY = """
name = "pockets"
commands = [
  "stagectl plan pocket.json --planner {planner} --untrained --pockets 2 --seed {seed} --out p.json --json plan.json",
]
files = ["pocket.json"]
[seeds]
count = %d
[settings.values]
planner = ["sequential"]
[figures.total]
file = "plan.json"
path = "pockets[*].total"
reduce = "mean"
unit = "s"
passes = "<= 27"
[figures.gap]
file = "plan.json"
path = "pockets[-1].gap"
"""


@dataclass
class Hands:
    """What performs tasks in this process, without running anything."""

    performed: Callable[[Task], Outcome]
    slots: int = 1
    lost: tuple[type[BaseException], ...] = ()

    def __post_init__(self) -> None:
        self.executor = ThreadPoolExecutor(self.slots)
        self.seen: list[Task] = []

    def perform(self, task: Task) -> Outcome:
        """Take it down, and perform it."""
        self.seen.append(task)
        return self.performed(task)


class Meter:
    """What a study reports to."""

    def __init__(self) -> None:
        self.shown: list[float] = []
        self.said: list[str] = []

    def show(self, done: float, note: str = "") -> None:
        self.shown.append(done)

    def say(self, text: str) -> None:
        self.said.append(text)


def outcome(task: Task, cpu: float = 1.0, status: int = 0, value: float = 0.5) -> Outcome:
    """Return what may have come of a task; `cpu` in s."""
    figures = {} if status else dict.fromkeys(task.figures, value)
    missing = dict.fromkeys(task.figures)
    told = "error: 7" if status else ""
    return Outcome(
        task.key, status, int(status > 0), told, {**missing, **figures}, 2.0, cpu, "2026-01-01", software=software()
    )


def plan_of(folder: Path, text: str = "", count: int = 4) -> Plan:
    """Return the plan of a study file written to a folder."""
    (folder / "pocket.json").write_text(EXAMPLE_POCKET)
    file = folder / "study.toml"
    file.write_text(text or STUDY % count)
    return read_plan(file, programs.names())
