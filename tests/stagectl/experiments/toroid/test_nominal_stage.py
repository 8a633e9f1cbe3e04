"""The nominal models are those of the simulated stage within its inner loops at their defaults."""

import numpy as np
import pytest

from ctlblocks import Block, Graph, Port
from ctlblocks.clock import run_offline
from ctlblocks.recording import Recording
from ctlblocks.replay import Record, Replay
from firmware_sim.stage_blocks import PiezoStage
from stagectl.config import StageConfig
from stagectl.experiments.toroid.nominal_stage import nominal_model
from stagectl.stage.controller import PiezoController
from stagectl.stage.loop import inner_loops
from stagectl.still import Still

RATE, BEGIN, SAMPLES = 10_000.0, 4_000, 1_000
STEP = 2e-6
"""m, of the extension."""


def moved(step: float) -> np.ndarray:
    """Return the plate's position from the step on, shape (samples, 3), m; it still rings from its start."""
    config, names = StageConfig(), ("x", "y", "z")
    wanted = np.full((BEGIN + SAMPLES, 3), 40e-6)
    wanted[BEGIN:] += step
    graph = Graph(RATE)
    controller = PiezoController(inner_loops(config), config.limits)
    record = Record([Port("position", "m", 3)], BEGIN + SAMPLES)
    played = Replay(Recording(names, ("m",) * 3, RATE, wanted), {"extension": names})
    blocks: dict[str, Block] = {
        "wanted": played,
        "controller": controller,
        "plant": PiezoStage(noise=0.0),
        "still": Still(),
    }
    blocks["record"] = record
    for name, block in blocks.items():
        graph.add(name, block)
    graph.connect("wanted.extension", "controller.extension_reference")
    graph.connect("plant.extension", "controller.extension", delayed=True)
    graph.connect("plant.position", "record.position", delayed=True)
    for source, target in (("controller.request", "voltage"), ("still.force", "force"), ("still.base", "base")):
        graph.connect(source, f"plant.{target}")
    graph.prepare()
    controller.start(np.full(3, 500.0))
    run_offline(graph, BEGIN + SAMPLES)
    return record.recording().data[BEGIN:]


def test_a_step_of_the_extension_moves_the_plate_as_the_models_say() -> None:
    """For a tenth of a second, which the outer loops are designed for; loops and creep are not in the models."""
    apart = moved(STEP) - moved(0.0)
    for axis, name in enumerate("xyz"):
        foreseen = nominal_model(name, RATE).simulate(np.full((SAMPLES, 1), STEP))[:, 0]
        off = np.linalg.norm(apart[:, axis] - foreseen) / np.linalg.norm(foreseen)
        assert off < 0.2, f"{name}: {off:.2f}"


def test_an_axis_that_is_not_there_is_refused() -> None:
    with pytest.raises(ValueError, match="axis is 'a', must be one of x, y, z, or a model file"):
        nominal_model("a", RATE)
