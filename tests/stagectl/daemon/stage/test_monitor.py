"""What the monitor keeps of a run."""

import numpy as np

from rigkit import config as rig_file
from rigkit.experiment.pace import Pace
from stagectl.config import StageConfig
from stagectl.daemon.stage.monitor import Monitor
from stagectl.experiments.piezo.setup import Setup


def watched(samples: int, frames: int) -> tuple[Monitor, np.ndarray]:
    """Return a monitor that has seen errors of 1, 2, ... m on three axes, a run proper of 300 samples from 200 on."""
    settings = ["session.lead=2", "session.seconds=3", "stage.rate=100", "session.live=true", "limits.ramp=0.8"]
    made = Setup(rig_file.load(None, StageConfig, settings), (), ())
    monitor = Monitor(made)
    monitor.prepare(100.0, frames)
    reference = np.repeat(np.arange(1.0, samples + 1)[:, np.newaxis], 3, axis=1)
    for start in range(0, samples, frames):
        block = reference[start : start + frames]
        monitor.process(block, np.zeros_like(block), block)
    return monitor, reference


def test_errors_are_kept_from_the_run_proper_on_for_a_second_in_order() -> None:
    for frames in (1, 10):
        assert len(watched(200, frames)[0].error()) == 0
        monitor, reference = watched(230, frames)
        np.testing.assert_array_equal(monitor.error(), reference[200:])
        monitor, reference = watched(370, frames)
        np.testing.assert_array_equal(monitor.error(), reference[270:])
        np.testing.assert_array_equal(monitor.voltage, reference[-1])


def test_the_way_back_to_rest_is_no_error() -> None:
    monitor, reference = watched(600, 10)
    np.testing.assert_array_equal(monitor.error(), reference[400:500])


def test_a_simulation_waits_for_the_clock_and_does_not_make_up_for_what_it_missed() -> None:
    clock = [5.0]

    def sleep(seconds: float) -> None:
        clock[0] += seconds

    pace = Pace(100.0, lambda: clock[0], sleep)
    for sample in (10, 20):
        pace.until(sample)
    assert np.isclose(clock[0], 5.1)
    clock[0] += 1.0  # the machine was busy
    pace.until(30)
    assert np.isclose(clock[0], 6.1)
    assert (pace.late, round(pace.behind, 9)) == (1, 0.9)
    pace.until(40)
    assert np.isclose(clock[0], 6.2)
