"""The stage's rig file: one model a table, every key with unit, range and default."""

import math
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from rigkit.config import Section, code, keywords, setting
from rigkit.service.config import Daemon
from stagectl.characterisation import Characterisation
from stagectl.link.config import Laser, Link

Range = tuple[float, float]
PerAxis = tuple[float, ...]


class Rig(Section):
    """Which rig this is; a model measured on one rig is refused on another."""

    role = "wiring"

    name: str = setting("simulated-stage", "", "name of the rig, stored with every model and run", min_length=1)


class Stage(Section):
    """The stage: its axes, and how often they are controlled."""

    role = "wiring"

    axes: tuple[str, ...] = setting(("x", "y", "z"), "", "name of each axis", min_length=1, max_length=8)
    rate: float = setting(10_000.0, "samples/s", "sample rate of both loops", ge=100, le=100_000)


class Limits(Section):
    """Limits of set-points and outputs, on every axis."""

    voltage: Range = setting((0.0, 1000.0), "V", "lowest and highest piezo voltage")
    voltage_slew: float = setting(1.5e5, "V/s", "largest rate of change of a voltage", gt=0, le=1e8)
    extension: Range = setting((2e-6, 92e-6), "m", "lowest and highest reference of the piezo's extension")
    extension_slew: float = setting(0.2, "m/s", "largest rate of change of that reference", gt=0, le=100)
    travel: Range = setting((20e-6, 430e-6), "m", "lowest and highest reference of the plate's position")
    rest: Literal["middle", "zero"] = setting(
        "middle", "", "rest position after a stop or fault: the middle of the voltage range, or its lower end"
    )
    ramp: float = setting(0.2, "s", "raised-cosine ramp at start, stop, hold and fault", ge=0.001, le=10)

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        for name in ("voltage", "extension", "travel"):
            low, high = getattr(self, name)
            if not low < high:
                raise ValueError(f"limits.{name} is {low:g} to {high:g}, must rise")
        shortest = (self.voltage[1] - self.voltage[0]) * math.pi / 2 / self.voltage_slew
        if not self.ramp >= shortest:
            raise ValueError(
                f"limits.ramp is {self.ramp:g} s, must be >= {shortest:.3g} s to cross limits.voltage within "
                f"limits.voltage_slew {self.voltage_slew:g} V/s"
            )
        return self

    @property
    def rest_voltage(self) -> float:
        """Where voltages rest, V."""
        return self.voltage[0] if self.rest == "zero" else sum(self.voltage) / 2

    @property
    def rest_position(self) -> float:
        """Where the plate rests when it is held, m."""
        return self.travel[0] if self.rest == "zero" else sum(self.travel) / 2


class Sensors(Section):
    """Plausible range of each sensor; a violation for longer than `tolerated` is a fault that stops the stage."""

    position: Range = setting((-10e-6, 520e-6), "m", "lowest and highest plausible position")
    position_speed: float = setting(0.25, "m/s", "largest plausible speed of a position", gt=0, le=1e3)
    extension: Range = setting((-5e-6, 110e-6), "m", "lowest and highest plausible extension")
    extension_speed: float = setting(0.3, "m/s", "largest plausible speed of an extension", gt=0, le=1e3)
    stuck: float = setting(0.05, "s", "a sensor whose value is constant for so long is stuck", gt=0, le=60)
    tolerated: int = setting(
        3, "samples", "invalid samples in a row that are replaced by the last valid one", ge=0, le=100
    )

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        for name in ("position", "extension"):
            low, high = getattr(self, name)
            if not low < high:
                raise ValueError(f"sensors.{name} is {low:g} to {high:g} m, must rise")
        return self


class Inner(Section):
    """The PID that makes the measured extension follow its reference, (2.2), and feedforward from the reference."""

    gain: PerAxis = setting((0.065e-6,), "m/V", "extension per volt; one for all axes, or one an axis", min_length=1)
    bandwidth: PerAxis = setting(
        (3.0,), "Hz", "Ki gain / (2 pi): where the integral part alone has gain one; as gain", min_length=1
    )
    proportional: float = setting(0.0, "1", "Kp gain", ge=0, le=100)
    lead: float = setting(0.0, "s", "Kd gain", ge=-1, le=1)
    feedforward: float = setting(1.0, "1", "gain of the feedforward, times reference / gain", ge=0, le=2)
    smoothing: float = setting(2.5e-4, "s", "time constant of the derivative's low-pass", gt=0, le=1)
    tracking: float = setting(1e-3, "s", "time constant of the anti-windup", gt=0, le=10)
    hysteresis: tuple[str, ...] = setting(
        (),
        "",
        "model file of each axis' hysteresis to compensate, from `calibrate hysteresis`; empty for none",
        files=("",),
    )


class Outer(Section):
    """The LQG feedback with integral state that makes the position follow its reference, (2.3)-(2.5)."""

    bandwidth: PerAxis = setting(
        (200.0,), "Hz", "of the integral action, at most; one for all axes, or one an axis", min_length=1
    )
    drive: PerAxis = setting(
        (10.0,), "m/m", "upper bound of the LQ weight: extension per position error; as bandwidth", min_length=1
    )
    disturbance: float = setting(
        30.0, "Hz", "frequency of the references that the design follows; forces count at a tenth of it", gt=0, le=2_000
    )
    push: float = setting(
        0.0,
        "1",
        "weight of the largest response to a force at any frequency: > 0 where the cut responds to vibrations",
        ge=0,
        le=10,
    )
    compliance: float = setting(
        0.0,
        "1",
        "weight of the responses to forces at `disturbance` and at a third of it: > 0 for a stiff axis",
        ge=0,
        le=10,
    )
    reach: float = setting(200.0, "Hz", "the models are valid up to here", gt=0, le=50_000)
    beyond: PerAxis = setting(
        (1.0,),
        "1",
        "largest gain of the controller above `reach`, re the plant's static gain",
        min_length=1,
    )
    allowed: PerAxis = setting(
        (), "1", "gain allowed at every frequency there, as found by `calibrate stage`; none: beyond"
    )
    forward_beyond: float = setting(
        12.0,
        "1",
        "largest gain from the reference there, re the plant's static gain: it excites unmodelled modes",
        gt=0,
    )
    max_sensitivity: float = setting(2.2, "1", "bound on Ms, with `delay` more than the plant's", ge=1.1, le=10)
    delay: int = setting(1, "samples", "extra delay for which the bound on Ms holds", ge=0, le=20)
    mistuning: float = setting(0.05, "1", "relative error of the natural frequencies, either way", ge=0, le=0.5)
    mistuned_sensitivity: float = setting(
        3.0,
        "1",
        "bound on Ms with that error, and on the largest response to a reference with or without it",
        ge=1.1,
        le=20,
    )
    feedforward: float = setting(1.0, "1", "upper bound: part of the l_r that leaves no error on a ramp", ge=0, le=1)
    resonances: tuple[float, ...] = setting(
        (), "Hz", "frequencies of disturbances that are cancelled (internal model)", max_length=5
    )
    resonance_width: float = setting(2.0, "Hz", "width of the band in which they are", gt=0, le=100)
    resonance_damping: float = setting(0.0, "1", "damping ratio of those states", ge=0, le=0.5)


class ChosenWeights(Section):
    """The outer loops' weights that `calibrate stage` chose, one of each an axis; none: chosen at every start."""

    bandwidth: PerAxis = setting((), "Hz", "of the integral action; 0 for an axis whose weights are not chosen yet")
    drive: PerAxis = setting((), "m/m", "LQ weight: extension per position error")
    trust: PerAxis = setting((), "1", "part of the identified noise that the Kalman filter is designed for")
    doubt: PerAxis = setting((), "m/m", "noise in the extension that it is designed for, re that of the position")
    caution: PerAxis = setting((), "1", "weight of each mode by itself")
    feedforward: PerAxis = setting((), "1", "part of the l_r that leaves no error on a ramp")
    notch: PerAxis = setting((), "1", "damping ratio of notches around narrow resonances; none, or 0: no notches")
    beyond: PerAxis = setting((), "1", "gain allowed above outer.reach with these weights; none, or 0: outer.beyond")
    forward_share: PerAxis = setting((), "1", "part used of the allowed gains from the reference above outer.reach")


class Reference(Section):
    """Reference of the plate; with `deflection.on`, of the tool in the workpiece."""

    signal: str = setting(
        "hold", "", "hold, or a WAV or CSV file of positions in m, a channel an axis", files=(".wav", ".csv")
    )
    position: PerAxis = setting((225e-6,), "m", "position of hold; one for all axes, or one an axis", min_length=1)


class Deflection(Section):
    """The robot's deflection, measured by the laser, is subtracted from the reference: the tool keeps its path."""

    on: bool = setting(False, "", "compensate")
    delay: int = setting(2, "samples", "delay of the laser re the position sensors", ge=0, le=1_000)
    corner: float = setting(2000.0, "Hz", "of a first-order low-pass for the laser's noise", gt=0, le=50_000)
    learn: bool = setting(
        True, "", "design a prefilter for the deflection measured in a run without compensation: session.compare"
    )
    prefilter: str = setting("", "", "prefilter.json of an earlier run, in place of a new one", files=(".json",))


class Session(Section):
    """Length of a run, its hardware, and its recording."""

    role = "patience"

    live: bool = setting(
        False, "", "the stage behind [link], with a controller of its own; else the one of [simulator]", role="plant"
    )
    seconds: float = setting(20.0, "s", "length of the run", gt=0, le=3_600)
    lead: float = setting(1.0, "s", "before the run: time to settle and start", ge=0.05, le=60)
    recording: Literal["csv", "wav"] = setting("csv", "", "format of the recording; a WAV is smaller and quicker")
    compare: bool = setting(False, "", "first run it without compensation of the deflection")


class Simulator(Section):
    """The simulated stage; a live run does not read it."""

    role = "plant"

    plant: str = code("firmware_sim.stage_blocks:PiezoStage", "module:Class of the stage's Block")
    options: dict[str, Any] = keywords("keywords it is built with", "plant")
    surroundings: str = code(
        "stagectl.still:Still", "module:Class of the Block that disturbs it: force and base motion"
    )
    surroundings_options: dict[str, Any] = keywords("keywords it is built with", "surroundings")


class StageConfig(Section):
    """A whole rig file of the stage."""

    rig: Rig = Field(default_factory=Rig)
    stage: Stage = Field(default_factory=Stage)
    limits: Limits = Field(default_factory=Limits)
    sensors: Sensors = Field(default_factory=Sensors)
    inner: Inner = Field(default_factory=Inner)
    outer: Outer = Field(default_factory=Outer)
    weights: ChosenWeights = Field(default_factory=ChosenWeights)
    reference: Reference = Field(default_factory=Reference)
    deflection: Deflection = Field(default_factory=Deflection)
    session: Session = Field(default_factory=Session)
    characterisation: Characterisation = Field(default_factory=Characterisation)
    link: Link = Field(default_factory=Link)
    laser: Laser = Field(default_factory=Laser)
    simulator: Simulator = Field(default_factory=Simulator)
    daemon: Daemon = Field(default_factory=Daemon)

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        axes = len(self.stage.axes)
        for table, key in (
            ("inner", "gain"),
            ("inner", "bandwidth"),
            ("outer", "bandwidth"),
            ("outer", "drive"),
            ("outer", "beyond"),
            ("reference", "position"),
        ):
            values = getattr(getattr(self, table), key)
            if len(values) not in (1, axes) or not all(value > 0 for value in values):
                raise ValueError(f"{table}.{key} is {values}, must be 1 or {axes} numbers > 0")
        if len(self.outer.allowed) not in (0, 1, axes) or not all(value > 0 for value in self.outer.allowed):
            raise ValueError(f"outer.allowed is {self.outer.allowed}, must be none, or 1 or {axes} numbers > 0")
        if len(self.inner.hysteresis) not in (0, axes):
            raise ValueError(f"inner.hysteresis has {len(self.inner.hysteresis)} files, must have none or {axes}")
        for key, values in self.weights:
            if key in ("notch", "beyond", "forward_share") and not values:
                continue  # rig files from before have none
            if len(values) != (axes if self.weights.bandwidth else 0) or not all(value >= 0 for value in values):
                raise ValueError(f"weights.{key} is {values}, must be {axes} numbers >= 0, or none in all of [weights]")
        if not self.session.lead >= 2.5 * self.limits.ramp:
            raise ValueError(
                f"session.lead is {self.session.lead:g} s, must be >= {2.5 * self.limits.ramp:g} s: two of limits.ramp "
                "and some rest"
            )
        return self
