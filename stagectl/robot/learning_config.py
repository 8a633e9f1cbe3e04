"""The tables of the cell's file about forces from motor torques: how friction is found, and how forces are told."""

from typing import Literal, Self

from pydantic import Field, model_validator

from rigkit.config import Section, setting

Six = tuple[float, float, float, float, float, float]


class Friction(Section):
    """The sweep through the workspace that shows friction and gravity; six numbers are one a joint."""

    lowest: Six = setting((-40.0, -20.0, -50.0, -80.0, -80.0, -80.0), "deg", "of the poses that are visited")
    highest: Six = setting((40.0, 40.0, 25.0, 80.0, 80.0, 80.0), "deg", "of the poses that are visited")
    poses: int = setting(
        20, "", "how many; the arm moves between them, in each the joints creep to and fro", ge=6, le=500
    )
    seed: int = setting(1, "", "which poses", ge=0)
    speed: float = setting(
        0.14, "rad/s", "of the fastest joint in every second move; half of it in the others", gt=0, le=2
    )
    creep: tuple[float, ...] = setting(
        (0.06, 0.01, 0.025, 0.004), "rad/s", "peak speeds of the motions to and fro, in turn", min_length=1
    )
    seconds: float = setting(4.0, "s", "of each motion to and fro", ge=2, le=60)
    smoothing: float = setting(
        0.012, "s", "time constant of the low-pass that joint speeds are seen behind", ge=0, le=0.5
    )
    left_out: float = setting(
        0.005, "1", "part of the samples at a speed that may be below the range, and as many above", gt=0, le=0.1
    )

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        wrong = [speed for speed in self.creep if not 0 < speed <= self.speed]
        if wrong:
            raise ValueError(
                f"friction.creep is {wrong[0]} rad/s, must be > 0 and at most friction.speed, {self.speed}"
            )
        return self


class Margin(Section):
    """What the bounds of forces from motor torques hold beside friction."""

    noise: float = setting(3.0, "1", "of each torque, in standard deviations as the sweep showed them", ge=0, le=10)
    moment: float = setting(0.3, "N m", "the largest of the cut about the tool, any way", ge=0, le=100)
    inertia: float = setting(
        4.0,
        "1",
        "times a joint's inertia times its acceleration as it is seen; links behind elastic gears have more than it",
        ge=0,
        le=100,
    )


class ForceEstimation(Section):
    """Forces on the tool from motor torques."""

    tie_break: Literal["centre", "minimum-norm"] = setting(
        "centre", "", "of forces that are as likely: with friction in the middle of its ranges, or the smallest"
    )
    margin: Margin = Field(default_factory=Margin)
