"""The table `[characterisation]` of a rig file: how a model is measured."""

from typing import Literal

from rigkit.config import Section, setting


class Characterisation(Section):
    """How a model is measured: a preloaded stepped sine, (6.2)-(6.6), or multisines on top of a preload."""

    method: Literal["multisine", "stepped", "both"] = setting(
        "multisine", "", "both: multisine, then a stepped sine at the bins of largest variance"
    )
    band: tuple[float, float] = setting((15.0, 650.0), "Hz", "first and last probe frequency")
    step: float = setting(1.0, "Hz", "spacing of the first pass", gt=0, le=50)
    tone: float = setting(0.5, "s", "length of a tone", ge=0.1, le=10)
    settle: float = setting(0.1, "s", "settling time before a tone is measured", ge=0, le=10)
    preload: float = setting(0.7, "V", "amplitude A of the preload, on both sides", ge=0, le=100)
    preload_band: tuple[float, float] = setting((40.0, 90.0), "Hz", "range of the preload's frequency")
    probe: float = setting(0.1, "V", "amplitude B of the probe, on one side at a time", gt=0, le=100)
    tukey: float = setting(0.5, "1", "tapered part of the window, 0 rectangular, 1 Hann", ge=0, le=1)
    passes: Literal[1, 2] = setting(2, "", "2: once more with a grid refined around peaks and notches")
    finest: float = setting(0.25, "Hz", "smallest spacing of the refined grid", gt=0, le=50)
    records: int = setting(8, "", "multisine: records of one period; more than there are coils", ge=2, le=64)
    period: float = setting(5.0, "s", "multisine: length of a period; bins are 1 / period apart", ge=1, le=20)
    run_in: float = setting(0.5, "s", "multisine: played before each measured period", ge=0.1, le=10)
    operating: float = setting(0.36, "V", "multisine: rms of the preload, as of the drive in use", ge=0, le=100)
    level: float = setting(-30.0, "dB", "multisine: its density re that of the preload in its band", ge=-80, le=-10)
    quiet: bool = setting(False, "", "multisine: no preload, and every bin within the limit that the reference sets")
    around: Literal["band", "reference"] = setting(
        "band", "", "preload of the multisine: the band, or the drive that the reference needs, from a first multisine"
    )
