"""The tables of the robot cell's file that milling by segments reads: where, how the tool moves, the simulated cell."""

from typing import Any

from rigkit.config import Section, code, keywords, setting

Six = tuple[float, float, float, float, float, float]


class SegmentTask(Section):
    """Where a pocket is milled segment by segment, and how the tool moves in between."""

    home: Six = setting(
        (0.0, 0.0, 0.0, 0.0, 1.5708, 0.0), "rad", "joints, the tool over the pocket's middle, `lift` up"
    )
    cell: float = setting(2e-3, "m", "side of a cell of the pocket; the tool has G of them", ge=1e-4, le=0.05)
    depth: float = setting(3e-3, "m", "of the cut", ge=1e-4, le=0.05)
    lift: float = setting(5e-3, "m", "above the workpiece, where the tool travels", ge=5e-4, le=0.1)
    travel: float = setting(0.1, "m/s", "speed above the workpiece", gt=0, le=0.25)
    plunge: float = setting(0.02, "m/s", "speed down into it", gt=0, le=0.1)
    step: float = setting(0.01, "m/s", "speed from strip to strip where the tool stays down", gt=0, le=0.1)
    acceleration: float = setting(1.0, "m/s^2", "of these, and at the end of a segment", gt=0, le=20)
    pause: float = setting(0.1, "s", "at rest before a segment begins", ge=0, le=10)
    stationary: float = setting(0.3, "s", "of force control before its force counts as stationary", ge=0, le=10)
    margin: float = setting(0.02, "m", "the tool stays within so much of the pocket", gt=0, le=0.5)
    slowest: float = setting(0.2, "s", "a safe feed is the lowest mean of the feed over so long", gt=0, le=10)
    patience: float = setting(60.0, "s", "a segment that takes longer is a fault", gt=0, le=3_600)


class FeedPlants(Section):
    """What is milled without the wood; robot and force sensor are those of `plants`."""

    cut: str = code("firmware_sim.oak_blocks:OakCut", "module:Class of the cut's Block")
    cut_options: dict[str, Any] = keywords("keywords it is built with", "cut")
    process: str = code("firmware_sim.feed_blocks:FedTool", "module:Class of the process of fig. 7.5")
    process_options: dict[str, Any] = keywords("keywords it is built with", "process")
