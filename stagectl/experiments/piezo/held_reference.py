"""The wanted positions of a run, which may be held at any moment: they come to a stop, and go on from there."""

from collections.abc import Callable

import numpy as np

from ctlblocks.block import Block, Port
from ctlblocks.recording import Recording
from rigkit.stream_writer import Tell

RESUMED = "resumed"
"""The event of a reference that goes on; its `samples` are those that it was held, in all."""

_PLAYING, _SLOWING, _HELD, _STARTING = range(4)


class HeldReference(Block):
    """Play wanted positions once, from the first sample; after the last they stay.

    To hold, the pace falls from one sample a sample to none as a raised cosine, in `ramp`, and rises again likewise;
    meanwhile positions are interpolated between samples.  While it is never held every sample is played as it is.

    Ports: `position` (m), one wide an axis, out.

    Parameters
    ----------
    wanted : Recording, m
        `prepare` refuses any rate but its own.
    ramp : float, s
    within : slice, samples
        Of the recording, in which it may be held.

    Attributes
    ----------
    played : float, samples of the recording
        A whole number unless the pace is changing.
    held : int, samples
        By which it is later than it would be otherwise, so far; of a hold that is over, all of it.
    """

    def __init__(self, wanted: Recording, ramp: float, within: slice) -> None:
        self.outputs = (Port("position", "m", len(wanted.names)),)
        self._data, self._rate, self._within = np.asarray(wanted.data, float), wanted.rate, within
        self._half = max(1, round(ramp * wanted.rate / 2))
        self._pace = 0.5 + 0.5 * np.cos(np.pi * (np.arange(2 * self._half) + 0.5) / (2 * self._half))
        self._is_asked = False

    def prepare(self, rate: float, frames: int) -> None:
        """Begin with the first sample."""
        if rate != self._rate:
            raise ValueError(f"the recording has {self._rate:g} samples/s, must be {rate:g} to be followed here")
        self.played, self.held = 0.0, 0
        self._state, self._step, self._from = _PLAYING, 0, 0

    def process(self, position: np.ndarray) -> None:
        """Play one frame."""
        frames, first = len(position), int(self.played)
        if self._state == _PLAYING and not self._begins_to_slow and first + frames <= len(self._data):
            position[:] = self._data[first : first + frames]
            self.played = float(first + frames)
            return
        for n in range(frames):
            self._turn()
            position[n] = self._at(self.played)
            self._go_on()

    def hold(self, on: bool) -> None:
        """Ask for a hold, or for its end (between ticks)."""
        self._is_asked = on

    @property
    def is_held(self) -> bool:
        """Whether it stays where it is."""
        return self._state == _HELD

    @property
    def is_playing(self) -> bool:
        """Whether it plays at its own pace."""
        return self._state == _PLAYING

    @property
    def _begins_to_slow(self) -> bool:
        room = self._within.stop - 2 * self._half  # to come to a stop, and back to its pace
        return self._is_asked and self._within.start <= self.played < room

    def _turn(self) -> None:
        """Go over to another state, where it is time."""
        if self._state == _PLAYING and self._begins_to_slow:
            self._state, self._step, self._from = _SLOWING, 0, int(self.played)
        elif self._state == _HELD and not self._is_asked:
            self._state, self._step, self._from = _STARTING, 0, int(self.played)

    def _go_on(self) -> None:
        if self._state == _PLAYING:
            self.played += 1.0
        elif self._state == _HELD:
            self.held += 1
        else:
            slowing = self._state == _SLOWING
            self.played += float(self._pace[self._step] if slowing else self._pace[-1 - self._step])
            self._step += 1
            if self._step == 2 * self._half:  # half of them were played: the sum of the cosine, but for rounding
                self.played, self.held = float(self._from + self._half), self.held + self._half
                self._state = _HELD if slowing else _PLAYING

    def _at(self, place: float) -> np.ndarray:
        """Return the positions between two samples, shape (axes,), m."""
        first = min(int(place), len(self._data) - 1)
        after = min(first + 1, len(self._data) - 1)
        found: np.ndarray = self._data[first] + (place - first) * (self._data[after] - self._data[first])
        return found


class Holding:
    """Holds a reference as it is told between ticks, and tells when it has come to a stop, and has its pace again.

    Parameters
    ----------
    reference : HeldReference
    tell : callable(event, fields)
    now : callable() -> int, samples
        Of the run so far.
    """

    def __init__(self, reference: HeldReference, tell: Tell, now: Callable[[], int]) -> None:
        self._reference, self._tell, self._now, self._is_told = reference, tell, now, False

    def __call__(self, on: bool) -> None:
        """Hold it, or let it go on."""
        reference = self._reference
        reference.hold(on)
        if reference.is_held and not self._is_told:
            self._tell("held", {"sample": self._now()})
            self._is_told = True
        elif reference.is_playing and self._is_told:
            self._tell(RESUMED, {"sample": self._now(), "samples": reference.held})
            self._is_told = False
