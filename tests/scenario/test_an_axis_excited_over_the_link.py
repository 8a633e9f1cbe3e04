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
    node = CanNode(SlcanAdapter(path), processor, image.stick)
    stop = threading.Event()
    thread = threading.Thread(target=node.run, args=(stop,))
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


def response(emitted: np.ndarray, heard: np.ndarray) -> np.ndarray:
    """Return the frequency response from the voltage to the position of z, m/V, at 30 to 60 Hz."""
    rest = slice(1_000, 3_000)
    voltage, position = (signal - signal[rest].mean() for signal in (emitted[:, 0], heard[:, 3 + Z]))
    frequency = np.fft.rfftfreq(len(voltage), 1e-4)
    band = (frequency > 30) & (frequency < 60)
    found: np.ndarray = (np.fft.rfft(position) / np.fft.rfft(voltage))[band]
    return found


def test_a_chirp_over_the_link_shows_the_stage_that_one_in_process_shows(tmp_path: Path) -> None:
    chirp = Chirp(10_000.0, 0.3, 1.0, 20.0, 100.0, 6.0).drive()
    config = RIG.model_copy(update={"link": RIG.link.model_copy(update={"channel": str(tmp_path / "can")})})
    repeated: list[str] = []
    with stage_behind(tmp_path / "can"), StageLink(config.link) as link:
        live = LiveBench(config, Z, None, link, lambda: False, repeated.append)
        emitted, heard = live.emit(chirp)
        assert link.reason == ""
        assert link.state in (State.EXCITED, State.RAMPING, State.HOLDING)
    assert (emitted.shape, heard.shape) == ((13_000, 1), (13_000, 6))
    np.testing.assert_allclose(emitted[:, 0], 500.0 + np.round(chirp[:, 0] / 0.05) * 0.05, atol=1e-9)
    ratio = response(emitted, heard) / response(*Bench(RIG, Z, None, lambda: False).emit(chirp))
    assert np.abs(np.abs(ratio) - 1).mean() < 0.05
    assert np.abs(np.degrees(np.angle(ratio)).mean()) < 0.8  # a sample is 1.6 degrees at 45 Hz
    assert np.ptp(heard[:, 3:5], axis=0).max() < 0.2 * np.ptp(heard[:, 3 + Z])
