"""The stage behind its link as a bench: the same excitations, played and heard by its own processor."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from calibration.stage_axes.bench import centre_of
from stagectl.config import StageConfig
from stagectl.link.excitation import Heard, SamplesLost, excited
from stagectl.link.stage_link import StageLink
from stagectl.link.upload import upload
from stagectl.stage.inner_parameters import inner_parameters
from stagectl.stage.loop import inner_loops
from stagectl.stage.piezo_pid import Pid
from stagectl.wire.messages import AXES, DRIVES, RATE, Drive
from stagectl.wire.samples import rounded

ATTEMPTS = 5
"""Times that an excitation is played in which samples were lost, before it is given up."""


@dataclass(frozen=True)
class LiveBench:
    """The stage behind `link`, with one axis excited and the others at their rest voltage.

    Parameters
    ----------
    config : StageConfig
        Three axes at the wire's rate.
    axis : int, counted from 0
    loop : Pid or None
        The axis' inner loop, whose reference is excited; None: its voltage is.
    link : StageLink
        Open.
    stopped : callable() -> bool
        Asked now and then whether to give up.
    tell : callable(str)
        Told of each excitation that has to be repeated, and why.

    Raises
    ------
    ValueError : the stage has other axes, or another rate.
    """

    config: StageConfig
    axis: int
    loop: Pid | None
    link: StageLink
    stopped: Callable[[], bool]
    tell: Callable[[str], object]

    def __post_init__(self) -> None:
        """Refuse a stage that is not the wire's."""
        stage = self.config.stage
        if len(stage.axes) != len(AXES) or stage.rate != RATE:
            raise ValueError(
                f"stage.axes has {len(stage.axes)} at {stage.rate:g} samples/s, must be {len(AXES)} at {RATE}, as on "
                "the wire"
            )

    def emit(self, drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Excite the axis about its rest: `experiment.Emit`.

        Parameters
        ----------
        drive : array, shape (samples, 1), V or m
            Deviation from rest.

        Returns
        -------
        emitted : array, shape (samples, 1), V or m
            What the guard let out, or the reference, as rounded by the wire.
        heard : array, shape (samples, 9), m
            Extension and position of every axis, as the controllers read them; zeros, since no laser is on this wire.

        Raises
        ------
        SamplesLost : each of `ATTEMPTS` times.
        LinkFault : a fault has latched.
        Stopped : it was asked for.
        """
        kind = Drive.VOLTAGE if self.loop is None else Drive.EXTENSION
        if self.loop is not None:
            loops = inner_loops(self.config)
            loops[self.axis] = self.loop
            upload(self.link, inner_parameters(AXES, loops))
        played = rounded(DRIVES[kind], drive[:, 0])
        heard = self._heard(kind, played)
        emitted = heard.voltage[:, self.axis] if self.loop is None else centre_of(self.config, self.loop) + played
        return emitted[:, np.newaxis], np.hstack([heard.extension, heard.position, np.zeros_like(heard.position)])

    def _heard(self, kind: Drive, played: np.ndarray) -> Heard:
        lead = 2.5 * self.config.limits.ramp
        for attempt in range(1, ATTEMPTS + 1):
            try:
                return excited(self.link, kind, self.axis, played, lead, self.stopped)
            except SamplesLost as fault:
                if attempt == ATTEMPTS:
                    raise SamplesLost(f"{ATTEMPTS} recordings had to be discarded, the last: {fault}") from None
                self.tell(f"recording {attempt} is discarded: {fault}")
        raise AssertionError("the loop above returns or raises")
