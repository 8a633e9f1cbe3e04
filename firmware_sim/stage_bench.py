"""The simulated stage on the bench: its processor behind a CAN adapter, the laser sensor behind a serial line."""

from collections.abc import Callable, Sequence
from pathlib import Path
from threading import Event, Thread
from time import monotonic
from typing import Any

import numpy as np

from firmware_sim.can_node import CanNode, Mishap
from firmware_sim.plate_file import write_plate
from firmware_sim.serial_node import SerialNode
from firmware_sim.slcan_adapter import SlcanAdapter
from firmware_sim.stage_image import StageImage
from firmware_sim.stage_processor import Loops, Settings, StageProcessor
from rigkit.priority import undisturbed
from stagectl.link.config import Laser
from stagectl.wire.messages import BLOCK


class StageBench:
    """Both devices, as symbolic links in a folder.

    Parameters
    ----------
    folder : Path
        Gets `can` and `laser`, and `plate`: where the plate is, for a simulated tracker.
    image : StageImage
    settings : Settings
    laser : Laser
        How the sensor's controller is set.
    laser_axis : int, counted from 0, the axis it looks along
    mishaps : sequence of Mishap
    """

    def __init__(
        self,
        folder: Path,
        image: StageImage,
        settings: Settings,
        laser: Laser,
        laser_axis: int,
        mishaps: Sequence[Mishap] = (),
    ) -> None:
        self.can, self.laser = folder / "can", folder / "laser"
        image.tick(np.zeros((BLOCK, 3)))  # compiles
        self._image, self._place = image, folder / "plate"
        self._plate = write_plate(self._place)
        processor = StageProcessor(
            Loops(self._tick, image.commit, image.clear, image.excite, image.release, image.follow, image.leave),
            settings,
            monotonic(),
        )
        self.node = CanNode(SlcanAdapter(self.can), processor, image.suffer, mishaps)
        seen = image.absolute
        self._sensor = SerialNode(self.laser, lambda: float(seen[laser_axis]), laser.mode, unit=laser.scale)

    def _tick(self, references: np.ndarray) -> dict[str, Any]:
        """Run ten samples, and show where the plate is."""
        signals = self._image.tick(references)
        self._plate[:] = np.nan_to_num(signals["position"][-1])
        return signals

    def run(self, ready: Callable[[], None], stop: Event) -> None:
        """Serve until `stop` is set, then take both devices away.

        Parameters
        ----------
        ready : callable()
            Called once both can be opened.
        stop : Event
        """
        with undisturbed():
            sensor = Thread(target=self._sensor.run, args=(stop,), name="laser", daemon=True)
            sensor.start()
            try:
                ready()
                self.node.run(stop)
            finally:
                stop.set()
                sensor.join()
                self._place.unlink(missing_ok=True)
