"""An axis of the simulated stage behind its adapter is excited by a weak chirp, as `calibrate stage --live` does.

Guards against drive and response that are not of the same samples: a model made of them would have a delay that the
stage has not, and loops designed on it would be too slow or unstable.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from calibration.stage_axes.bench import Bench
from calibration.stage_axes.chirp import Chirp
from calibration.stage_axes.live_bench import LiveBench
from firmware_sim.can_node import CanNode
from firmware_sim.slcan_adapter import SlcanAdapter
from firmware_sim.stage_image import StageImage
from firmware_sim.stage_processor import Loops, Settings, StageProcessor
from rigkit import config as rig_file
from stagectl.config import StageConfig
from stagectl.link.stage_link import StageLink
from stagectl.wire.messages import State
from tests.stagectl.link.stand_in import PATIENT

Z = 2
RIG = rig_file.load(None, StageConfig, ["limits.ramp=0.05", f"link.silence={PATIENT}", "link.patience=20"])


@contextmanager
def stage_behind(path: Path) -> Iterator[None]:
    """Run the simulated stage behind an adapter, in a thread, a block for each that the host sends."""
    image = StageImage(RIG)
    image.tick(np.zeros((10, 3)))  # compiles
    loops = Loops(image.tick, image.commit, image.clear, image.excite, image.release)
    processor = StageProcessor(loops, Settings(silence=PATIENT, ramp=0.05, pace="host"), monotonic())
    node = CanNode(SlcanAdapter(path), processor, image.suffer)
    stop = threading.Event()
    thread = threading.Thread(target=node.run, args=(stop,))
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


def moved(heard: np.ndarray) -> np.ndarray:
    """Return how z moved in the band of the chirp, m: without creep, which depends on how long the stage has rested."""
    position = heard[:, 3 + Z]
    band = butter(3, [15.0, 300.0], "bandpass", fs=10_000.0, output="sos")
    found: np.ndarray = sosfiltfilt(band, position - position.mean())[3_000:-500]
    return found


def off(one: np.ndarray, other: np.ndarray) -> float:
    """Return the rms difference of two signals re the rms of the second."""
    return float(np.linalg.norm(one - other) / np.linalg.norm(other))


@pytest.mark.slow
def test_a_chirp_over_the_link_shows_the_stage_that_one_in_process_shows(tmp_path: Path) -> None:
    chirp = Chirp(10_000.0, 0.3, 1.0, 20.0, 100.0, 6.0).drive()
    config = RIG.model_copy(update={"link": RIG.link.model_copy(update={"channel": str(tmp_path / "can")})})
    repeated: list[str] = []
    with stage_behind(tmp_path / "can"), StageLink(config.link) as link:
        live = LiveBench(config, Z, None, link, lambda: False, repeated.append)
        emitted, heard = live.emit(chirp)
        assert link.reason == ""
        assert link.state in (State.EXCITED, State.RAMPING, State.HOLDING)
    assert (emitted.shape, heard.shape) == ((13_000, 1), (13_000, 9))
    np.testing.assert_allclose(emitted[:, 0], 500.0 + np.round(chirp[:, 0] / 0.05) * 0.05, atol=1e-9)
    alone = moved(Bench(RIG, Z, None, lambda: False).emit(chirp)[1])
    beside = {late: off(moved(heard)[9:-9], np.roll(alone, late)[9:-9]) for late in range(-3, 4)}
    assert beside[0] < 0.02  # one sample late it is 0.05
    assert min(beside, key=beside.__getitem__) == 0
    assert np.ptp(heard[:, 3:5], axis=0).max() < 0.2 * np.ptp(heard[:, 3 + Z])
