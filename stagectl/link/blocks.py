"""The link as Blocks: what the stage measures comes in, references go out."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.link.stage_link import StageLink
from stagectl.wire.messages import AXES, Drive

_UNITS = {"position": "m", "extension": "m", "voltage": "V"}


class Receive(Block):
    """Give the stage's position sample by sample, in order: `position` (m, 3) out.

    Samples lost on the way are held, so that those after them keep their time.  Where a graph asks for more than has
    come, the last one is held and counted in `missed`.

    Parameters
    ----------
    link : StageLink
        While its fault is latched, a tick raises `LinkFault`.
    """

    outputs = (Port("position", "m", len(AXES)),)

    def __init__(self, link: StageLink) -> None:
        self.missed = 0
        self._link = link
        self._ring, _ = link.signal("position")

    def prepare(self, rate: float, frames: int) -> None:
        """Begin with the next sample that comes; the rate must be the wire's."""
        _refuse_other_rate(self._link, rate)
        self.missed = 0
        self._last = np.full(len(AXES), self._link.link.origin)
        self._ring.skip()

    def process(self, position: np.ndarray) -> None:
        """Take one frame."""
        if self._link.reason:
            self._link.refuse_when_latched()
        count = self._ring.take(position)
        position[:count] += self._link.link.origin
        if count < len(position):
            self.missed += len(position) - count
            position[count:] = position[count - 1] if count else self._last
        self._last[:] = position[-1]


class ReceiveAbsolute(Block):
    """Give what the stage's lasers saw, sample by sample beside the positions of `Receive`: `absolute` (m, 3) out.

    NaN until the first has come.  What was lost on the way is held, as positions are.

    Parameters
    ----------
    link : StageLink
        While its fault is latched, a tick raises `LinkFault`.
    """

    outputs = (Port("absolute", "m", len(AXES)),)

    def __init__(self, link: StageLink) -> None:
        self.link = link
        self._ring, _ = link.signal("absolute")
        self._positions, _ = link.signal("position")

    def prepare(self, rate: float, frames: int) -> None:
        """Begin with the next sample that comes; the rate must be the wire's."""
        _refuse_other_rate(self.link, rate)
        self._ring.skip()
        self._last, self._one = np.full(len(AXES), np.nan), np.zeros((1, len(AXES)))

    def process(self, absolute: np.ndarray) -> None:
        """Take one frame."""
        if self.link.reason:
            self.link.refuse_when_latched()
        while len(self._ring) > len(self._positions) + len(absolute):  # it stood still while positions were passed over
            self._ring.take(self._one)
        count = self._ring.take(absolute)
        absolute[:count] += self.link.link.origin
        absolute[count:] = absolute[count - 1] if count else self._last
        self._last[:] = absolute[-1]


class Newest(Block):
    """Hold the newest sample of a signal that comes now and then: `extension` (m, 3) or `voltage` (V, 3) out.

    NaN until the first has come.

    Parameters
    ----------
    link : StageLink
        While its fault is latched, a tick raises `LinkFault`.
    signal : str, "extension" or "voltage"
    """

    def __init__(self, link: StageLink, signal: str) -> None:
        self.outputs = (Port(signal, _UNITS.get(signal, "1"), len(AXES)),)
        self._link = link
        _, self.sample = link.signal(signal)

    def process(self, *signals: np.ndarray) -> None:
        """Fill one frame."""
        if self._link.reason:
            self._link.refuse_when_latched()
        signals[0][:] = self.sample


class Send(Block):
    """Send the stage its references: `reference` (m, 3) in.

    Nothing is sent before `StageLink.start` and after a fault.

    Parameters
    ----------
    link : StageLink
        While its fault is latched, a tick raises `LinkFault`.
    """

    inputs = (Port("reference", "m", len(AXES)),)

    def __init__(self, link: StageLink) -> None:
        self._link = link

    def prepare(self, rate: float, frames: int) -> None:
        """Allocate; the rate must be the wire's."""
        _refuse_other_rate(self._link, rate)
        self._shifted = np.zeros((frames, len(AXES)))

    def process(self, reference: np.ndarray) -> None:
        """Hand over one frame."""
        if self._link.reason:
            self._link.refuse_when_latched()
        np.subtract(reference, self._link.link.origin, out=self._shifted)
        self._link.references.put(self._shifted)


class Excite(Block):
    """Send the stage the deviation from rest of an axis that is excited: `deviation` (V or m, 3) in.

    Nothing is sent before `StageLink.excite` and after a fault.

    Parameters
    ----------
    link : StageLink
        While its fault is latched, a tick raises `LinkFault`.
    drive : Drive
        Its unit.
    """

    def __init__(self, link: StageLink, drive: Drive) -> None:
        self.inputs = (Port("deviation", "V" if drive is Drive.VOLTAGE else "m", len(AXES)),)
        self._link = link

    def prepare(self, rate: float, frames: int) -> None:
        """Refuse another rate than the wire's."""
        _refuse_other_rate(self._link, rate)

    def process(self, deviation: np.ndarray) -> None:
        """Hand over one frame."""
        if self._link.reason:
            self._link.refuse_when_latched()
        self._link.references.put(deviation)


def _refuse_other_rate(link: StageLink, rate: float) -> None:
    if rate != link.rate:
        raise ValueError(f"the graph runs at {rate:g} samples/s, must be {link.rate:g} for link.form {link.link.form}")
