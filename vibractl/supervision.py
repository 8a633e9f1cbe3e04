"""What the daemon adds to an audio line: a limit to standing still, and faults on purpose."""

from dataclasses import dataclass

from rigkit.faults import FaultTable
from vibractl.audio_stream import channels
from vibractl.config import Audio


@dataclass(frozen=True)
class Supervision:
    """How a line is looked after.

    Parameters
    ----------
    mute_after : float, s
        The drive is at zero when the program has stood still for so long; 0 only when it has died.
    faults : FaultTable or None
        Of the card's inputs, see `input_names`; None where no faults may be put in.
    """

    mute_after: float = 0.0
    faults: FaultTable | None = None


ALONE = Supervision()
"""As at the command line: nobody but the program itself."""


def input_names(audio: Audio) -> tuple[str, ...]:
    """Return what is on each of the card's inputs: response_1, far_field_1, loopback, or input_4 where nothing is."""
    names = [f"input_{number + 1}" for number in range(channels(audio)[0])]
    for kind, wired in (("response", audio.response_channels), ("far_field", audio.far_field_channels)):
        for number, channel in enumerate(wired, start=1):
            names[channel - 1] = f"{kind}_{number}"
    if audio.alignment == "loopback":
        names[audio.loopback_input - 1] = "loopback"
    return tuple(names)
