"""The tables of the robot cell's file that learning to mill reads: the pocket, and the learning."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from rigkit.config import Section, setting

Inverse = Literal["regularised", "mirrored"]
Length = Annotated[float, Field(gt=0, le=1)]
Six = tuple[float, float, float, float, float, float]


class Pocket(Section):
    """A pocket milled in rounds from the middle outwards; the robot holds the spindle, its tool's axis is z."""

    arm: str = setting(
        "", "", "simulate another arm than robot.arm holding the spindle; empty: robot.arm", files=(".toml",)
    )
    home: Six = setting(
        (0.0, 0.349066, 0.174533, 0.0, 1.047198, 0.0), "rad", "its joints, the tool over the middle on the surface"
    )
    size: tuple[Length, Length] = setting((28e-3, 28e-3), "m", "of the pocket along x and y")
    depth: float = setting(2e-3, "m", "of the pocket, all of it at once", gt=0, le=0.05)
    tool: float = setting(6e-3, "m", "diameter of the end mill", gt=0, le=0.05)
    step: float = setting(4e-3, "m", "from round to round", gt=0, le=0.05)
    slope: float = setting(0.0625, "1", "at which the path descends, at most", gt=0, le=1)
    corner: float = setting(1e-3, "m", "radius by which corners of the path are blended", gt=0, le=0.02)
    feed: float = setting(10e-3, "m/s", "along the path", ge=1e-3, le=0.05)
    ramp: float = setting(0.3, "s", "duration of the ramp of the feed at start and end", gt=0, le=10)
    clearance: float = setting(
        1e-3, "m", "height over the surface at which a trial begins and ends, and to which it retracts", gt=0, le=0.1
    )
    lead: float = setting(1.5, "s", "before the path: time to settle", ge=1, le=60)
    tail: float = setting(1.0, "s", "at rest after it", ge=0.5, le=60)
    retreat: float = setting(0.4, "s", "duration of a retract to the clearance", ge=0.1, le=10)
    workpiece: tuple[Length, Length, Length] = setting(
        (50e-3, 50e-3, 6e-3), "m", "the block along x, y and z, the pocket in its middle"
    )
    wall: float = setting(1e-3, "m", "smallest thickness of the block that remains, floor and sides", gt=0, le=0.1)
    margin: float = setting(0.01, "m", "largest distance of the tool from its path", gt=0, le=0.5)

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if not min(self.size) > self.tool + 4 * self.corner:
            raise ValueError(
                f"pocket.size is {self.size} m, must be > {self.tool + 4 * self.corner:g}: the tool and four corners"
            )
        if not self.step <= self.tool:
            raise ValueError(f"pocket.step is {self.step:g} m, must be <= pocket.tool {self.tool:g} m")
        room = [block - pocket for block, pocket in zip(self.workpiece, (*self.size, self.depth), strict=True)]
        least = (2 * self.wall, 2 * self.wall, self.wall)
        if not all(each > wall for each, wall in zip(room, least, strict=True)):
            raise ValueError(
                f"pocket.workpiece is {self.workpiece} m, must leave pocket.wall {self.wall:g} m around the pocket"
            )
        return self


class Learning(Section):
    """Learning from trial to trial."""

    model: str = setting("milling.h5", "", "model file, as `calibrate milling` writes it", min_length=1, files=("",))
    free: int = setting(2, "", "air cuts that are learned from, before the first trial in material", ge=1, le=20)
    cutoff: float = setting(10.0, "Hz", "of Q, a low-pass without phase", ge=0.1, le=50)
    highest: float = setting(25.0, "Hz", "upper limit of the frequencies that are learned", ge=0.2, le=100)
    gain: float = setting(1.0, "1", "part of the computed correction that is applied in one trial", gt=0, le=1)
    inverse: Inverse = setting("regularised", "", "how L inverts G_R: regularised, or mirrored (zeros)")
    epsilon: float = setting(1e-3, "1", "of the regularised inverse", ge=0, le=1)
    cut: Literal["measured", "model"] = setting(
        "measured", "", "response of the cut to a speed: measured along the path in the last trial, or G_M"
    )
    gap: float = setting(0.05, "s", "longest gap without a sample in a log", gt=0, le=1)
    correction: float = setting(
        3e-3,
        "m",
        "largest displacement of the tool by learning; in place of limits.correction",
        gt=0,
        le=5e-3,
    )
    stray: float = setting(2e-3, "m", "largest distance of a corrected path from the reference path", gt=0)

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if not self.highest > self.cutoff:
            raise ValueError(f"learning.highest is {self.highest:g} Hz, must be > learning.cutoff {self.cutoff:g} Hz")
        return self


class LearningChirp(Section):
    """The chirps that `calibrate milling` identifies G_R from, on top of the pocket's feed."""

    share: float = setting(0.6, "1", "speed of a chirp over the feed it rides on", gt=0, lt=1)
    largest: float = setting(1.5e-3, "m", "amplitude at low frequencies", gt=0, le=0.01)
    seconds: float = setting(8.0, "s", "of each", ge=4, le=60)
    start: float = setting(0.3, "Hz", "where they begin; they end a little above learning.highest", gt=0, le=5)
    height: float = setting(0.07, "m", "above the workpiece, of the middle", gt=0, le=0.5)
