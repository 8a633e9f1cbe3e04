"""The marine vibrator's rig file: one model a table, every key with unit, range and default."""

from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal, Self

from pydantic import Field, model_validator

from rigkit.config import Section, code, keywords, setting
from rigkit.relay.config import Relay
from rigkit.service.config import Daemon
from vibractl.channel_map import collision
from vibractl.characterisation_config import Characterisation
from vibractl.learning.kinds_of_law import KINDS
from vibractl.reference_forms import choices
from vibractl.spectrum_config import Spectrum

Channels = tuple[int, ...]
if TYPE_CHECKING:
    LawName = str
else:
    LawName = Literal[tuple(KINDS)]


class Rig(Section):
    """Which rig this is; a model measured on one rig is refused on another."""

    role = "wiring"

    name: str = setting("simulated-vibrator", "", "name of the rig, stored with every model and run", min_length=1)


class Audio(Section):
    """The audio interface: one full-duplex stream for the whole session."""

    role = "wiring"

    stream: str = code("firmware_sim.audio:Stream", "module:Class with sounddevice.Stream's constructor", role="plant")
    device: str = setting("", "", "device name, for input and output alike; empty for the default", role="plant")
    rate: int = setting(44_100, "samples/s", "sample rate", ge=8_000, le=192_000)
    blocksize: int = setting(512, "samples", "samples a callback", ge=16, le=8_192, role="patience")
    drive_channels: Channels = setting((1, 2), "", "output channel of each coil, counted from 1", min_length=1)
    response_channels: Channels = setting((1, 2), "", "input channel of each accelerometer", min_length=1)
    far_field_channels: Channels = setting(
        (), "", "input channel of each hydrophone, or microphone in air; none if empty"
    )
    alignment: Literal["loopback", "marker"] = setting(
        "loopback", "", "proof of alignment: a cable from output to input, or a short marker through the vibrator"
    )
    loopback_output: int = setting(3, "", "output channel of the loopback cable", ge=1, le=64, role="patience")
    loopback_input: int = setting(3, "", "input channel of the loopback cable", ge=1, le=64, role="patience")
    heartbeat_output: int = setting(
        0,
        "",
        "output of a tone for a relay in the amplifier's supply, while all is well; 0 for none",
        ge=0,
        le=64,
        role="patience",
    )
    output_full_scale: float = setting(10.0, "V", "drive at digital full scale", gt=0, le=1_000)
    input_full_scale: float = setting(400.0, "m/s^2", "response at digital full scale", gt=0, le=1e6)
    far_field_full_scale: float = setting(200.0, "Pa", "sound pressure at digital full scale", gt=0, le=1e6)
    isolated: bool = setting(True, "", "run the stream in a process of its own", role="patience")
    attempts: int = setting(
        3, "", "times a shot with an xrun, a slip or a bad sample is tried", ge=1, le=20, role="patience"
    )
    relay: Relay = Field(default_factory=Relay)

    @model_validator(mode="after")
    def _beats_no_quicker_than_it_plays(self) -> Self:
        shortest = 2 * self.blocksize / self.rate
        if self.relay.bus and not self.relay.period >= shortest:
            raise ValueError(
                f"audio.relay.period is {self.relay.period:g} s, must be >= {shortest:.3g} s, two blocks of "
                "audio.blocksize: a frame confirms that blocks are played"
            )
        return self


class Limits(Section):
    """Limits of the guard.  A violation fades the drive to zero and latches."""

    peak: float = setting(9.0, "V", "largest drive", gt=0, le=1_000)
    slew: float = setting(20_000.0, "V/s", "largest rate of change of a drive", gt=0, le=1e8)
    rms: float = setting(5.0, "V", "largest root mean square of a drive", gt=0, le=1_000)
    rms_seconds: float = setting(1.0, "s", "time constant of that mean", gt=0, le=60)
    ramp: float = setting(0.02, "s", "raised-cosine ramp at start, stop and fault", gt=0, le=1)


class Reference(Section):
    """What the vibrator is to emit."""

    signal: str = setting("chirp:40:90:5", "", choices("a WAV or CSV file"), files=(".wav", ".csv"))
    amplitude: float = setting(10.0, "m/s^2", "amplitude of a chirp or sine", gt=0, le=1e4)
    full_scale: float = setting(
        0.0,
        "m/s^2",
        "digital full scale of an integer WAV file; 0: unknown, such a file is refused",
        ge=0,
        le=1e4,
    )
    taper: float = setting(0.04, "1", "part of a chirp or sine that is tapered, at each end", ge=0, le=0.5)


class Shot(Section):
    """Silence around the reference: room for the ramp and the marker before, for latency and ring-down after."""

    lead: float = setting(0.2, "s", "silence before the reference", ge=0.05, le=5)
    tail: float = setting(0.4, "s", "silence after it, for the ring-down: judged and learned as well", ge=0.1, le=10)


class Learning(Section):
    """Frequency-domain iterative learning control, (6.9)-(6.19)."""

    law: LawName = setting(
        "kalman", "", "kalman re-estimates G from shot to shot, see [adaptation]; thesis keeps the model"
    )
    side: int = setting(0, "", "the one side that is driven and controlled; 0 for all", ge=0, le=64)
    band: tuple[float, float] = setting((15.0, 650.0), "Hz", "f_ILC: bins that are learned")
    gains: tuple[float, ...] = setting(
        (), "1", "Q2 by stage; empty for 0.8, 0.4; thesis: (6.24) on a sine, else (6.25)"
    )
    stages: tuple[int, ...] = setting((), "shots", "shots in each stage but the last")
    regularisation: Literal["per-line", "constant"] = setting(
        "per-line", "", "how the inverse (6.19) is regularised near notches"
    )
    epsilon: float = setting(1e-3, "1", "per-bin weight, times ||G||^2 of the bin", ge=0, le=1)
    floor: float = setting(1e-5, "1", "per-bin floor, times max ||G||^2", ge=0, le=1)
    constant_epsilon: float = setting(
        0.01, "(m/s^2/V)^2", "the thesis' eps, for regularisation = constant", ge=0, le=1e6
    )
    start: Literal["by-law", "reference", "inverse", "library"] = setting(
        "by-law", "", "first drive: scaled reference (thesis), or G^+ R (kalman); library is set by run --warm"
    )
    quiet: bool = setting(False, "", "start at low level and rise as the emission above quality.above allows")
    check_levels: tuple[float, ...] = setting(
        (-12.0, -6.0, 0.0), "dB", "levels at which a stored drive is verified, rising to 0", min_length=1
    )
    structure: Literal["mimo", "decentralised", "common"] = setting(
        "mimo", "", "all sides jointly, each side by itself (diverges), or one common drive (poor)"
    )
    sensors: Literal["accelerometers", "far-field"] = setting(
        "accelerometers", "", "sensors whose errors are learned; far-field only where the objective is stated there too"
    )
    weights: tuple[float, ...] = setting(
        (), "1", "weight of each of those sensors where not all errors can be made small; empty: 1 each"
    )
    overtones: int = setting(4, "", "overtones of a sine that are learned beside its fundamental", ge=0, le=60)
    decimation: Literal[1, 4] = setting(
        4, "1", "decimation of the sample rate for learning; 4 as in the thesis, 1: full rate"
    )


class Adaptation(Section):
    """What law = kalman adds to the thesis' law; each part can be switched off by itself."""

    model: bool = setting(True, "", "estimate G from the changes of drive and response between shots")
    walk: float = setting(
        0.02, "1", "process noise: standard deviation of the change of G from shot to shot, re its size", ge=1e-4, le=1
    )
    doubt: float = setting(0.2, "1", "standard deviation of G added to the model's own, re its size", ge=0, le=2)
    neighbours: int = setting(4, "bins", "bins to each side that the estimate of a bin's G uses", ge=0, le=50)
    drift: float = setting(0.005, "1", "part of G U that changes from shot to shot at a constant drive", ge=0, le=1)
    spill: float = setting(0.2, "1", "leakage of a step into other bins", ge=0, le=2)
    coupling: float = setting(4.0, "1", "relative change of the distortion over that of the strong bins", ge=0, le=20)
    scatter: float = setting(0.1, "1", "leakage of a step into other bins, re the mean |G| around them", ge=0, le=2)
    variation: bool = setting(True, "", "estimate the variation of G within a shot: at its ends, and in between")
    stretch: bool = setting(True, "", "track modes whose frequencies drift, and extrapolate G to the next shot")
    cautious: bool = setting(
        True, "", "smaller steps where the error is mostly noise, has grown, or a step changes the distortion"
    )
    rollback: bool = setting(True, "", "return to the best drive when the error has grown twice")


class Watch(Section):
    """Divergence and reidentification, (6.20)-(6.23)."""

    on: bool = setting(False, "", "detect bands that diverge, and reidentify them during the run")
    band: tuple[float, float] = setting((100.0, 645.0), "Hz", "f_div: where divergence is looked for")
    eta_1: float = setting(1.0, "1", "weight of the error re the limit in (6.20)", ge=0, le=100)
    eta_2: float = setting(0.0, "1", "weight of the drive's growth since the bin was best", ge=0, le=100)
    delta: float = setting(1.0, "1", "threshold of (6.20)", gt=0, le=100)
    half_width: float = setting(10.0, "Hz", "f_D: half of the band that is reidentified", ge=2, le=100)
    share: float = setting(0.5, "1", "kappa: part of the headroom below the limit that the chirp uses", gt=0, le=1)
    rounds: int = setting(2, "", "reidentifications of a band before it is frozen", ge=1, le=20)
    input: Literal["kept", "zeroed"] = setting(
        "kept", "", "the drive in the band meanwhile: kept, or zeroed as in the thesis, which biases the estimate"
    )


class Session(Section):
    """How many shots, and how they are stored."""

    role = "patience"

    shots: int = setting(30, "shots", "shots of the run", ge=1, le=100_000)
    recording: Literal["wav", "csv"] = setting("wav", "", "format of shots/0000.wav ...")
    check: bool = setting(
        True, "", "begin with a weak burst; stop where the channels are not those that were calibrated"
    )


class Quality(Section):
    """When a shot meets the objective."""

    where: Literal["accelerometers", "far-field"] = setting(
        "accelerometers", "", "the sensors at which the objective is judged"
    )
    objective: float = setting(-40.0, "dB", "limit on errors above `above`, re the reference's spectrum", ge=-120, le=0)
    above: float = setting(100.0, "Hz", "the limit holds from here ...", gt=0, le=20_000)
    judged_to: float = setting(
        2000.0, "Hz", "... to here, learned or not: the upper end of the sensors' specified range", gt=0, le=20_000
    )
    mains: bool = setting(True, "", "exclude mains hum, estimated from the silences, from judgement and learning")


class Simulator(Section):
    """The simulated rig; read by firmware_sim alone."""

    role = "plant"

    plant: str = code(
        "vibrator",
        "vibrator, impulse-response, or package.module:Class of a Block",
        pattern=None,
        short="firmware_sim.laboratory:PLANTS",
    )
    speed: float = setting(0.0, "1", "multiple of real time; 0: as fast as possible", ge=0, le=1_000, role="patience")
    options: dict[str, Any] = keywords("keywords the plant is built with", "plant")


class RigConfig(Section):
    """A whole rig file."""

    rig: Rig = Field(default_factory=Rig)
    audio: Audio = Field(default_factory=Audio)
    limits: Limits = Field(default_factory=Limits)
    reference: Reference = Field(default_factory=Reference)
    shot: Shot = Field(default_factory=Shot)
    learning: Learning = Field(default_factory=Learning)
    adaptation: Adaptation = Field(default_factory=Adaptation)
    spectrum: Spectrum = Field(default_factory=Spectrum)
    watch: Watch = Field(default_factory=Watch)
    session: Session = Field(default_factory=Session)
    quality: Quality = Field(default_factory=Quality)
    characterisation: Characterisation = Field(default_factory=Characterisation)
    simulator: Simulator = Field(default_factory=Simulator)
    daemon: Daemon = Field(default_factory=Daemon)

    @model_validator(mode="after")
    def _has_a_channel_for_each(self) -> Self:
        if fault := collision(self.audio):
            raise ValueError(fault)
        far = len(self.audio.far_field_channels)
        for key, where in (("quality.where", self.quality.where), ("learning.sensors", self.learning.sensors)):
            if where == "far-field" and not far:
                raise ValueError(f"{key} is far-field, but audio.far_field_channels is empty")
        if self.learning.sensors == "far-field" and self.quality.where != "far-field":
            raise ValueError(f"learning.sensors is far-field, but quality.where is {self.quality.where}")
        sensors = far if self.learning.sensors == "far-field" else len(self.audio.response_channels)
        weights = self.learning.weights
        if weights and not (len(weights) == sensors and min(weights) >= 0 and max(weights) > 0):
            raise ValueError(f"learning.weights is {list(weights)}, must be {sensors} numbers >= 0, not all 0")
        return self

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        nyquist = self.audio.rate / 2 / self.learning.decimation
        for table, key, (low, high) in (
            ("learning", "band", self.learning.band),
            ("characterisation", "band", self.characterisation.band),
            ("characterisation", "preload_band", self.characterisation.preload_band),
            ("watch", "band", self.watch.band),
        ):
            if not 0 < low < high < nyquist:
                raise ValueError(f"{table}.{key} is {low:g} to {high:g} Hz, must rise within 0 to {nyquist:g} Hz")
        if not self.quality.above < min(self.quality.judged_to, nyquist):
            raise ValueError(
                f"quality.above is {self.quality.above:g} Hz, must be < quality.judged_to, "
                f"{self.quality.judged_to:g} Hz, and < {nyquist:g} Hz, half the rate learned at"
            )
        levels = (-80.0, *self.learning.check_levels)
        if levels[-1] != 0.0 or not all(low < high for low, high in pairwise(levels)):
            raise ValueError(
                f"learning.check_levels is {list(levels[1:])}, must rise from above -80 dB and end at 0 dB"
            )
        return self
