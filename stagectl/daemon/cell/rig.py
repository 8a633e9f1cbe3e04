"""The robot cell as the daemon's rig."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Protocol

from rigkit.code_name import resolve
from rigkit.disk_space import refuse_full
from rigkit.faults import FaultTable
from rigkit.named_code import KnownCode
from rigkit.service.filed_rig import FiledRig
from rigkit.service.not_begun import making
from rigkit.service.rig import Desk, Procedure
from rigkit.service.show import Gauge
from stagectl.daemon.cell.procedures import procedures
from stagectl.experiments.toroid.plan import stage_of
from stagectl.robot.config import CellConfig
from stagectl.robot.port import arm_of


class UnderWay(Protocol):
    """A procedure that has been made, and runs."""

    def run(self) -> None:
        """Run it to its end."""

    def stop(self) -> None:
        """Let the robot retreat or hold, at its next look; from any thread."""

    def gauges(self) -> Sequence[Gauge]:
        """Return what is measured now."""


class RobotCell(FiledRig[CellConfig]):
    """A robot cell under the daemon, simulated in process.

    Parameters
    ----------
    load : callable() -> CellConfig
        Reads the cell's file, with the settings laid over it; again at each reload.

    Raises
    ------
    ValueError : the file cannot be used.
    """

    program = "stagectl"
    faults: FaultTable | None = None

    def __init__(self, load: Callable[[], CellConfig]) -> None:
        super().__init__(load)
        _refuse_unusable(self.config)
        self._known = KnownCode(self.config, stage_of(None))
        self.name = self.config.rig.name
        self._under_way: UnderWay | None = None
        self.procedures: Sequence[Procedure] = procedures(self._runner)

    def gauges(self) -> Sequence[Gauge]:
        """Return what the procedure under way measures, and room on the disk."""
        under_way = self._under_way
        found = [] if under_way is None else list(under_way.gauges())
        return [*found, self.room()]

    def arm(self) -> None:
        """See that there is room to record; each procedure opens what it needs."""
        refuse_full(Path(self.config.daemon.data))

    def disarm(self) -> None:
        """Nothing: what a procedure opens it closes."""

    def stop(self) -> None:
        """Let the robot retreat or hold."""
        under_way = self._under_way
        if under_way is not None:
            under_way.stop()

    def acknowledge(self, who: str) -> None:
        """Nothing: what has latched went with its run."""

    def close(self) -> None:
        """Nothing is open."""

    def _check(self, new: CellConfig) -> None:
        _refuse_unusable(new)
        self._known.refuse_other(new)

    def _runner(self, maker: str) -> Callable[[Desk, Any], None]:
        def run(desk: Desk, options: Any) -> None:
            with making(desk):
                for each in options.led_to(self.config.daemon.data):
                    self._known.refuse_other(each)
                self._under_way = under_way = resolve(maker)(self.config, options, desk)
            try:
                under_way.run()
            finally:
                self._under_way = None

        return run


def _refuse_unusable(config: CellConfig) -> None:
    """Refuse a cell's file that this daemon cannot serve, by ValueError."""
    if config.daemon.faults:
        raise ValueError(
            "daemon.faults is true, must be false for a robot cell: [plants] has options for faults of its sensors"
        )
    arm_of(config)
