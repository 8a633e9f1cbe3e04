"""The stage as the daemon's rig."""

from collections.abc import Callable, Iterable, Sequence
from typing import Protocol

from rigkit.code_name import resolve
from rigkit.faults import FaultTable
from rigkit.named_code import KnownCode
from rigkit.service.filed_rig import FiledRig
from rigkit.service.not_begun import making
from rigkit.service.reload import Change, Reach, taken
from rigkit.service.rig import Desk, Procedure
from rigkit.service.show import Gauge
from stagectl.config import StageConfig
from stagectl.daemon.gauges import linked, motion
from stagectl.daemon.options import CalibrationOptions, FollowOptions, HoldOptions, asked
from stagectl.daemon.stage.following import following
from stagectl.daemon.stage.ready import Ready
from stagectl.daemon.stage.spoiled import sensor_names

REACHES = {
    "session": Reach.PARAMETERS,
    "reference": Reach.PARAMETERS,
    "deflection": Reach.PARAMETERS,
    "session.live": Reach.DEVICES,
    "link": Reach.DEVICES,
    "simulator": Reach.DEVICES,
}


PAUSED = "The reference stops within limits.ramp, and continues from there. Recording continues."
CALIBRATION = "calibration.stage_axes.procedure:StageProcedure"
"""Found when it is asked for: calibration stands above this package."""
CALIBRATION_ENDS = (
    "The stage goes to rest, this excitation is discarded; begun again, it continues from the recordings."
)


class _UnderWay(Protocol):
    """A procedure while it runs."""

    def stop(self) -> None:
        """Take the stage to rest, from any thread."""

    def gauges(self) -> Iterable[Gauge]:
        """Return what is measured now, beside what a link gives: of a simulated stage, what is put out."""


class PiezoStage(FiledRig[StageConfig]):
    """A piezo stage under the daemon, behind its link or simulated in process.

    Parameters
    ----------
    load : callable() -> StageConfig
        Reads the rig file, with the settings laid over it; again at each reload.

    Raises
    ------
    ValueError : the file cannot be used.
    """

    program = "stagectl"
    reaches = REACHES

    def __init__(self, load: Callable[[], StageConfig]) -> None:
        super().__init__(load)
        self._known = KnownCode(self.config)
        self.name = self.config.rig.name
        self._ready: Ready | None = None
        self._under_way: _UnderWay | None = None
        self.faults = _fault_table(self.config)
        ends = "The stage goes to mid-travel, the recording is stored, and the rig stays armed."
        self.procedures: Sequence[Procedure] = (
            Procedure("follow", "Follow a reference", "run", "s", True, PAUSED, ends, FollowOptions, self._follow),
            Procedure("hold", "Hold a position", "run", "s", False, "", ends, HoldOptions, self._follow),
            Procedure(
                "calibrate",
                "Calibration",
                "calibrate",
                "axes",
                False,
                "",
                CALIBRATION_ENDS,
                CalibrationOptions,
                self._calibrate,
            ),
        )

    def gauges(self) -> Sequence[Gauge]:
        """Return travel, voltages and errors against limits, how the link does, and room on the disk."""
        ready, under_way = self._ready, self._under_way
        found: list[Gauge] = []
        link = None if ready is None else ready.link
        if ready is not None and link is not None:
            position = link.signal("position")[1] + link.link.origin
            found += motion(ready.config, position, link.signal("voltage")[1])
            found += linked(link)
        if under_way is not None:
            found += under_way.gauges()
        return [*found, self.room()]

    def arm(self) -> None:
        """Open the link, or see that there is room to record."""
        if self._ready is None:
            self._ready = Ready(self.config)

    def disarm(self) -> None:
        """Close the link; one that has latched stays open, to be acknowledged."""
        if self._ready is not None and not self._ready.is_at_fault:
            self.close()

    def stop(self) -> None:
        """Take the stage to mid-travel."""
        under_way = self._under_way
        if under_way is not None:
            under_way.stop()

    def acknowledge(self, who: str) -> None:
        """End a fault of the link and of the stage behind it; a simulated stage went with its run."""
        if self._ready is not None and self._ready.link is not None and self._ready.is_at_fault:
            self._ready.link.acknowledge(who)
        self.close()

    def _check(self, new: StageConfig) -> None:
        self._known.refuse_other(new)

    def _take(self, new: StageConfig, change: Change) -> str:
        """Take what a run is told from the next run on, the rest from the next arming on."""
        if self.faults is not None and self.faults.names != sensor_names(new):
            self.faults = FaultTable(sensor_names(new))
        now = [key for key, reach in change.keys.items() if reach is Reach.PARAMETERS]
        if self._ready is not None:
            self._ready.config = taken(self._ready.config, new, now)
        super()._take(new, change)
        later = len(now) < len(change.keys)
        return "; ".join(["from the next run on"] * bool(now) + ["the rest when it is armed again"] * later)

    def close(self) -> None:
        """Give up the link."""
        ready, self._ready = self._ready, None
        if ready is not None:
            ready.close()

    def _follow(self, desk: Desk, options: FollowOptions | HoldOptions) -> None:
        assert self._ready is not None, "a procedure begins armed"
        ready = self._ready
        with making(desk):
            procedure = following(ready, asked(ready.config, options), options, desk, self.faults)
        self._under_way = procedure
        try:
            procedure.run()
        finally:
            self._under_way = None

    def _calibrate(self, desk: Desk, options: CalibrationOptions) -> None:
        """Calibrate; what was chosen is in force from then on, until the rig file is read again."""
        assert self._ready is not None, "a procedure begins armed"
        with making(desk):
            procedure = resolve(CALIBRATION)(self._ready.config, options, desk, self._ready.link)
        self._under_way = procedure
        try:
            self.config = procedure.run()
        finally:
            self._under_way = None
        self._ready.take(self.config)


def _fault_table(config: StageConfig) -> FaultTable | None:
    if not config.daemon.faults:
        return None
    if config.session.live:
        raise ValueError("daemon.faults is true, must be false with session.live: a live stage's sensors are its own")
    return FaultTable(sensor_names(config))
