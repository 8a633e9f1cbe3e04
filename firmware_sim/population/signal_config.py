"""The settings of a drawn record for identification."""

from pydantic import Field

from rigkit.config import Section, setting


class Signals(Section):
    """A record for identification."""

    seed: int = setting(0, "", "which system", ge=0)
    family: str = setting("", "", "its kind of structure")
    samples: int = setting(2_000, "samples", "length of the record", ge=100, le=10_000_000)


class SignalConfig(Section):
    """What `firmware-sim draw signal` records."""

    signal: Signals = Field(default_factory=Signals)
