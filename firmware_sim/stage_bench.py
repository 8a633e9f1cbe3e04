"""The simulated stage on the bench: its processor behind a CAN adapter."""

from collections.abc import Callable, Sequence
from pathlib import Path
from threading import Event
from time import monotonic
from typing import Any

import numpy as np

from firmware_sim.can_node import CanNode, Mishap
from firmware_sim.plate_file import write_plate
from firmware_sim.slcan_adapter import SlcanAdapter
from firmware_sim.stage_image import StageImage
from firmware_sim.stage_processor import Loops, Settings, StageProcessor
from rigkit.priority import undisturbed
from stagectl.wire.messages import BLOCK


class StageBench:
    """The adapter, as a symbolic link in a folder.

    Parameters
    ----------
    folder : Path
        Gets `can`, and `plate`: where the plate is, for a simulated tracker.
    image : StageImage
    settings : Settings
    mishaps : sequence of Mishap
    """

    def __init__(
        self,
        folder: Path,
        image: StageImage,
        settings: Settings,
        mishaps: Sequence[Mishap] = (),
    ) -> None:
        self.can = folder / "can"
        image.tick(np.zeros((BLOCK, 3)))  # compiles
        self._image, self._place = image, folder / "plate"
        self._plate = write_plate(self._place)
        processor = StageProcessor(
            Loops(self._tick, image.commit, image.clear, image.excite, image.release, image.follow, image.leave),
            settings,
            monotonic(),
        )
        self.node = CanNode(SlcanAdapter(self.can), processor, image.suffer, mishaps)

    def _tick(self, references: np.ndarray) -> dict[str, Any]:
        """Run ten samples, and show where the plate is."""
        signals = self._image.tick(references)
        self._plate[:] = np.nan_to_num(signals["position"][-1])
        return signals

    def run(self, ready: Callable[[], None], stop: Event) -> None:
        """Serve until `stop` is set, then take the device away.

        Parameters
        ----------
        ready : callable()
            Called once it can be opened.
        stop : Event
        """
        with undisturbed():
            try:
                ready()
                self.node.run(stop)
            finally:
                stop.set()
                self._place.unlink(missing_ok=True)
