"""CONTRIBUTING.md's plant is one: a Block as every other, that a stage's graph takes by its name in the rig file."""

import sys
from pathlib import Path
from types import ModuleType

import pytest

from ctlblocks import Block
from rigkit import config as rig_file
from rigkit.experiment.runner import never
from stagectl.config import StageConfig
from stagectl.experiments.piezo.cell import Cell, memory, simulated
from stagectl.experiments.piezo.reference import wanted_position
from stagectl.experiments.piezo.setup import setup
from tests.contract.conformance import CHECKS, Example
from tests.contract.source_tree import ROOT
from tests.stagectl.experiments.piezo.simulated_models import write_models

PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
LONGEST = 32
"""Lines of the page's plant."""


@pytest.fixture
def plant(monkeypatch: pytest.MonkeyPatch) -> type[Block]:
    """Import the page's plant as `own_plant`."""
    source = next(part.split("```")[0] for part in PAGE.split("```python\n") if part.startswith('"""own_plant'))
    assert len(source.splitlines()) <= LONGEST
    module = ModuleType("own_plant")
    exec(source, module.__dict__)  # noqa: S102 (the page's own code)
    monkeypatch.setitem(sys.modules, "own_plant", module)
    made: type[Block] = module.LaggingStage
    return made


def test_it_does_what_every_block_does(plant: type[Block]) -> None:
    for check in CHECKS:
        check(Example(plant, rate=10_000.0))


@pytest.mark.usefixtures("plant")
def test_a_stage_is_run_on_it(tmp_path: Path) -> None:
    quick = ["simulator.plant=own_plant:LaggingStage", "session.lead=0.5", "session.seconds=0.2", "outer.mistuning=0.0"]
    made = setup(rig_file.load(None, StageConfig, quick), write_models(tmp_path))
    wanted, kept = wanted_position(made.config, made.timeline), memory(made, made.timeline.total)
    cell = Cell(made, wanted, simulated(made.config), False, {"record": kept})
    cell.run(lambda _: None, never)
    position = kept.recording().select(["position_1", "position_2", "position_3"]).data
    assert position.std(axis=0).min() > 1e-5  # m: the voltages have risen to rest, and it has followed them
