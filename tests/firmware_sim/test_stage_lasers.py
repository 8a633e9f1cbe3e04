"""The image on the stage's processor with its lasers: what it shows, compensates, and takes for a fault."""

import numpy as np
import pytest

from firmware_sim.stage_image import StageImage
from rigkit import config as rig_file
from stagectl.config import StageConfig
from stagectl.stage.deflection_parameters import DeflectionLoop, deflection_parameters
from stagectl.stage.laser_check import LaserLimits
from stagectl.wire.messages import AXES, Fault

REST = np.zeros((10, 3))


def following(cycles: float = 5_000.0, corner: float | None = None, milling: str = "") -> StageImage:
    """Return an image whose loops have come to rest and that follows, its lasers of so many readings a second."""
    image = StageImage(rig_file.load(None, StageConfig, [f"simulator.options={{laser_rate = {cycles}}}"]), milling)
    for _ in range(600):
        image.tick(REST)
    loop = DeflectionLoop(LaserLimits(cycles, 1e-3, 200.0, 0.25), corner)
    image.commit(deflection_parameters(AXES, loop))
    image.follow()
    return image


def played(image: StageImage, blocks: int) -> dict[str, np.ndarray]:
    """Return what it showed of so many blocks, shape (samples, 3) each."""
    kept = [{name: np.array(each) for name, each in image.tick(REST).items()} for _ in range(blocks)]
    return {name: np.concatenate([each[name] for each in kept]) for name in ("position", "absolute", "voltage")}


@pytest.mark.parametrize("cycles", [400.0, 1_000.0, 10_000.0])
def test_lasers_of_every_rate_are_shown_without_a_fault(cycles: float) -> None:
    image = following(cycles)
    shown = played(image, 300)
    assert image.tick(REST)["fault"] is Fault.NONE
    off = (shown["absolute"] - shown["position"])[500:]
    assert np.abs(off.mean(axis=0)).max() < 0.3e-6


def test_nothing_is_shown_before_parameters_switch_lasers_on_and_in_the_run_after_the_next() -> None:
    image = StageImage(rig_file.load(None, StageConfig, []))
    assert "absolute" not in image.tick(REST)
    image = following()
    assert "absolute" in image.tick(REST)
    image.leave()
    image.follow()
    assert "absolute" not in image.tick(REST)


@pytest.mark.parametrize(
    ("mishap", "fault"),
    [
        ("stuck-laser", Fault.LASER_STUCK),
        ("late-laser", Fault.LASER_STALE),
        ("silent-laser", Fault.LASER_STALE),
        ("jumping-laser", Fault.LASER_IMPOSSIBLE),
    ],
)
@pytest.mark.parametrize("cycles", [400.0, 5_000.0])
def test_a_laser_that_goes_wrong_takes_the_stage_to_rest_until_it_is_cleared(
    mishap: str, fault: Fault, cycles: float
) -> None:
    image = following(cycles, 0.4 * cycles)
    played(image, 100)
    image.suffer(mishap)
    played(image, 600)
    signals = image.tick(REST)
    assert signals["fault"] is fault
    np.testing.assert_allclose(signals["voltage"], signals["voltage"][0, 0])  # all at rest
    image.leave()
    image.clear()
    played_before = image.tick(REST)
    assert played_before["fault"] is Fault.NONE


@pytest.mark.slow
def test_what_the_robot_gives_way_is_compensated() -> None:
    left = {}
    for corner in (None, 2_000.0):
        shown = played(following(corner=corner, milling="y"), 3_000)
        left[corner] = np.abs(shown["absolute"][3_000:, 1]).mean()
    assert left[2_000.0] < 0.5 * left[None]
