"""The stage as the daemon's rig."""

from collections.abc import Callable, Sequence
from pathlib import Path

from rigkit import config as rig_file
from rigkit.disk_space import RESERVE, free
from rigkit.faults import FaultTable
from rigkit.service.reload import Change, Reach, change, taken
from rigkit.service.rig import Desk, Procedure
from rigkit.service.show import Gauge
from stagectl.config import StageConfig
from stagectl.daemon.following import Following
from stagectl.daemon.gauges import linked, motion, tracked
from stagectl.daemon.options import FollowOptions, HoldOptions, asked
from stagectl.daemon.ready import Ready
from stagectl.daemon.spoiled import sensor_names

REACHES = {
    "session": Reach.PARAMETERS,
    "reference": Reach.PARAMETERS,
    "deflection": Reach.PARAMETERS,
    "session.live": Reach.DEVICES,
    "link": Reach.DEVICES,
    "simulator": Reach.DEVICES,
}


class PiezoStage:
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

    def __init__(self, load: Callable[[], StageConfig]) -> None:
        self._load, self.config = load, load()
        self.name = self.config.rig.name
        self._ready: Ready | None = None
        self._following: Following | None = None
        self.faults = _fault_table(self.config)
        ends = "The stage goes to mid-travel, what has come is kept, and the rig stays armed."
        self.procedures: Sequence[Procedure] = (
            Procedure("follow", "Follow a reference", "run", "s", False, "", ends, FollowOptions, self._follow),
            Procedure("hold", "Hold a position", "run", "s", False, "", ends, HoldOptions, self._follow),
        )

    def gauges(self) -> Sequence[Gauge]:
        """Return travel, voltages and errors against limits, how the link does, and room on the disk."""
        ready, following = self._ready, self._following
        found: list[Gauge] = []
        link = None if ready is None else ready.link
        if ready is not None and link is not None:
            position = link.signal("position")[1] + link.link.origin
            found += motion(ready.config, position, link.signal("voltage")[1])
            found += linked(link)
        elif following is not None:
            found += motion(self.config, following.monitor.position, following.monitor.voltage)
        if ready is not None and following is not None:
            found += tracked(ready.config, following)
        there = free(Path(self.config.daemon.data).absolute())
        return [*found, Gauge("disk_free", "Room on the disk", there, "byte", low=RESERVE)]

    def arm(self) -> None:
        """Open the link, or see that there is all that the simulation needs."""
        if self._ready is None:
            self._ready = Ready(self.config)

    def disarm(self) -> None:
        """Close the link; one that has latched stays open, to be acknowledged."""
        if self._ready is not None and not self._ready.is_at_fault:
            self.close()

    def stop(self) -> None:
        """Take the stage to mid-travel."""
        following = self._following
        if following is not None:
            following.stop()

    def acknowledge(self, who: str) -> None:
        """End a fault of the link and of the stage behind it; a simulated stage went with its run."""
        if self._ready is not None and self._ready.link is not None and self._ready.is_at_fault:
            self._ready.link.acknowledge(who)
        self.close()

    def settings(self) -> str:
        """Return the rig file in force."""
        return rig_file.dump(self.config)

    def reload(self) -> Change:
        """Read the rig file again: what a run is told holds from the next one on, the rest from the next arming on."""
        new = self._load()
        found = change(self.config, new, REACHES)
        if found.reach is Reach.NOTHING:
            return found
        if new.daemon.data != self.config.daemon.data:
            raise ValueError("daemon.data cannot change while the daemon runs")
        if self.faults is not None and self.faults.names != sensor_names(new):
            self.faults = FaultTable(sensor_names(new))
        now = [key for key, reach in found.keys.items() if reach is Reach.PARAMETERS]
        if self._ready is not None:
            self._ready.config = taken(self._ready.config, new, now)
        self.config = new
        own = any(key.startswith("daemon.") for key in found.keys)
        later = len(now) + own < len(found.keys)
        parts = ["from the next run on" * bool(now), "the rest when it is armed again" * later]
        parts.append("[daemon] when the daemon is started again" * own)
        return Change(found.keys, "; ".join(filter(None, parts)))

    def close(self) -> None:
        """Give up the link."""
        ready, self._ready = self._ready, None
        if ready is not None:
            ready.close()

    def _follow(self, desk: Desk, options: FollowOptions | HoldOptions) -> None:
        assert self._ready is not None, "a procedure begins armed"
        ready = self._ready
        self._following = Following(ready, asked(ready.config, options), options.run, desk, self.faults)
        try:
            self._following.run()
        finally:
            self._following = None


def _fault_table(config: StageConfig) -> FaultTable | None:
    if not config.daemon.faults:
        return None
    if config.session.live:
        raise ValueError("daemon.faults is true, must be false with session.live: a live stage's sensors are its own")
    return FaultTable(sensor_names(config))
