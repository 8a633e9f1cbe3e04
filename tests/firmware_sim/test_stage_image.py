"""The stage's own graph around the simulated plant, as its processor runs it."""

import numpy as np
import pytest

from firmware_sim.stage_image import StageImage
from stagectl.config import Limits, Sensors, Stage, StageConfig
from stagectl.stage.inner_parameters import inner_parameters
from stagectl.stage.loop_parameters import loop_parameters
from stagectl.stage.piezo_pid import Pid
from stagectl.stage.servo import Servo
from stagectl.stage.state_feedback import StateFeedback
from stagectl.wire.messages import Drive, Fault
from stagectl.wire.parameters import pack_parameters, unpack_parameters
from tests.stagectl.experiments.piezo.linear_stage import model

CONFIG = StageConfig(
    limits=Limits(voltage=(0.0, 1000.0), voltage_slew=1.5e5, extension=(2e-6, 92e-6)),
    sensors=Sensors(position=(-10e-6, 520e-6), extension=(-5e-6, 110e-6)),
)
AXES = ("x", "y", "z")


def gentle_loops() -> list[StateFeedback]:
    """Return loops of an integral and a little state feedback, one an axis."""
    made = []
    for axis in AXES:
        known = model(axis)
        n = known.order
        servo = Servo(np.ones((1, 1)), np.full((1, 1), 1e-4), np.ones(1))
        feedback = 1e-3 * np.random.default_rng(n).standard_normal((1, n))
        made.append(StateFeedback(known, np.zeros((n, 1)), feedback, servo, np.full((1, 1), -0.5), 0.2))
    return made


def run(image: StageImage, reference: np.ndarray) -> np.ndarray:
    """Return the positions, shape (samples, 3), m from mid-travel."""
    blocks = reference.reshape(-1, 10, 3)
    return np.vstack([image.tick(block)["position"].copy() for block in blocks])


@pytest.fixture
def image() -> StageImage:
    made = StageImage(CONFIG)
    run(made, np.zeros((20_000, 3)))
    return made


def test_switched_on_it_goes_to_mid_travel(image: StageImage) -> None:
    assert np.abs(run(image, np.zeros((1000, 3)))).max() < 6e-6
    assert image.tick(np.zeros((10, 3)))["fault"] is Fault.NONE


def test_it_follows_a_slow_reference(image: StageImage) -> None:
    time = np.arange(20_000) / 10_000.0
    reference = 50e-6 * np.sin(2 * np.pi * 2.0 * time)[:, np.newaxis] * np.ones(3)
    error = run(image, reference) - reference
    assert np.abs(error[10_000:]).mean() < 8e-6


def test_a_stuck_sensor_latches_until_it_is_cleared_at_rest(image: StageImage) -> None:
    image.suffer("stuck-sensor")
    run(image, np.zeros((600, 3)))
    assert image.tick(np.zeros((10, 3)))["fault"] is Fault.SENSOR_STUCK
    with pytest.raises(ValueError, match="still goes to rest"):
        image.clear()
    run(image, np.zeros((3000, 3)))
    image.clear()
    run(image, np.zeros((20_000, 3)))
    signals = image.tick(np.zeros((10, 3)))
    assert signals["fault"] is Fault.NONE
    assert np.abs(signals["position"]).max() < 10e-6


def test_designed_loops_are_taken_from_parameters_without_a_step(image: StageImage) -> None:
    loops = gentle_loops()
    parameters = loop_parameters(AXES, loops)
    before = image.tick(np.zeros((10, 3)))["voltage"][-1].copy()
    image.commit(unpack_parameters(pack_parameters(parameters)))
    after = image.tick(np.zeros((10, 3)))["voltage"]
    assert np.abs(np.diff(np.vstack([before, after]), axis=0)).max() < 5.0
    taken = image._controller._outer  # noqa: SLF001 (what is in use)
    for loop, original in zip(taken, loops, strict=True):
        np.testing.assert_array_equal(loop.feedback, original.feedback)
        np.testing.assert_array_equal(loop.model.A, original.model.A)


def test_parameters_that_are_no_loops_are_refused_and_change_nothing(image: StageImage) -> None:
    good = loop_parameters(AXES, image._controller._outer)  # noqa: SLF001
    before = list(image._controller._outer)  # noqa: SLF001
    with pytest.raises(ValueError, match=r"parameter x\.forward is missing"):
        image.commit({name: value for name, value in good.items() if name != "x.forward"})
    with pytest.raises(ValueError, match=r"parameter w\.forward is unknown"):
        image.commit(good | {"w.forward": np.zeros(())})
    with pytest.raises(ValueError, match=r"parameter y\.gain has shape \(3,\), must be \(1, 1\)"):
        image.commit(good | {"y.gain": np.zeros(3)})
    assert image._controller._outer == before  # noqa: SLF001


def test_a_position_beyond_the_wires_range_is_not_valid(image: StageImage) -> None:
    image._plant.stuck_at = 600e-6  # noqa: SLF001
    signals = image.tick(np.zeros((10, 3)))
    assert np.isnan(signals["position"][1:, 1]).all()  # the first was read before
    assert image.tick(np.zeros((10, 3)))["fault"] is Fault.SENSOR_INVALID


def test_a_cut_moves_what_the_laser_sees() -> None:
    image = StageImage(CONFIG, "y")
    run(image, np.zeros((12_000, 3)))
    image.follow()
    seen = [image.absolute[1] - image.tick(np.zeros((10, 3)))["position"][-1, 1] for _ in range(2000)]
    assert np.ptp(seen) > 1e-6


def test_another_number_of_axes_is_refused() -> None:
    with pytest.raises(ValueError, match="stage.axes has 2 at 10000 samples/s, must be 3 at 10000"):
        StageImage(StageConfig(stage=Stage(axes=("x", "y"))))


def signals(image: StageImage, reference: np.ndarray) -> dict[str, np.ndarray]:
    """Run blocks of references, shape (samples, 3), and return all of every signal."""
    found: dict[str, list[np.ndarray]] = {"position": [], "extension": [], "voltage": []}
    for block in reference.reshape(-1, 10, 3):
        given = image.tick(block)
        for name, blocks in found.items():
            blocks.append(given[name].copy())
    return {name: np.vstack(blocks) for name, blocks in found.items()}


def sine(amplitude: float, samples: int) -> np.ndarray:
    wave = np.zeros((samples, 3))
    wave[:, 0] = amplitude * np.sin(2 * np.pi * 20.0 * np.arange(samples) / 10_000)
    return wave


def test_a_voltage_is_let_out_as_it_comes_while_the_other_axes_rest(image: StageImage) -> None:
    image.excite(Drive.VOLTAGE, 0)
    run(image, np.zeros((3_000, 3)))
    wave = sine(4.0, 1_000)
    heard = signals(image, wave)
    np.testing.assert_array_equal(heard["voltage"], 500.0 + wave)
    assert np.ptp(heard["extension"][:, 0]) > 0.1e-6


def test_a_position_is_the_one_that_the_loops_read_when_they_made_the_voltage(image: StageImage) -> None:
    """The plant shows it a sample late; the loops read that a sample later, and so does the wire."""
    image.excite(Drive.VOLTAGE, 0)
    run(image, np.zeros((3_000, 3)))
    step = np.zeros((10, 3))
    step[5:, 0] = 15.0
    extension = signals(image, step)["extension"][:, 0]
    assert np.abs(extension[6] - extension[5]) < 60e-9
    assert extension[7] - extension[5] > 120e-9


def test_the_inner_loop_follows_and_its_axis_holds_again_when_it_is_released(image: StageImage) -> None:
    image.commit(inner_parameters(AXES, [Pid(0.0, 2 * np.pi * 8 / 0.0894e-6, 0.0, 2.5e-4, 1e-3)] * 3))
    image.excite(Drive.EXTENSION, 0)
    run(image, np.zeros((6_000, 3)))
    wave = np.zeros((3_000, 3))
    wave[:, 0] = 0.5e-6
    heard = signals(image, wave)
    assert heard["extension"][-1_000:, 0].mean() == pytest.approx(47.5e-6, abs=0.1e-6)
    assert (heard["voltage"][:, 1:] == 500.0).all()
    image.release()
    run(image, np.zeros((20_000, 3)))
    assert image.tick(np.zeros((10, 3)))["fault"] is Fault.NONE
    assert np.abs(signals(image, np.zeros((1_000, 3)))["position"].mean(axis=0)).max() < 3e-6


def test_a_plate_that_leaves_its_travel_goes_to_rest_and_says_so(image: StageImage) -> None:
    image.excite(Drive.VOLTAGE, 0)
    run(image, np.zeros((3_000, 3)))
    away = np.zeros((4_000, 3))
    away[:, 0] = 499.0 * np.linspace(0.0, 1.0, 4_000)
    run(image, away)
    assert image.tick(np.zeros((10, 3)))["fault"] is Fault.TRAVEL
    run(image, np.zeros((3_000, 3)))
    image.release()
    image.clear()
    assert image.tick(np.zeros((10, 3)))["fault"] is Fault.NONE


def test_an_axis_that_is_not_there_is_not_excited(image: StageImage) -> None:
    with pytest.raises(ValueError, match="axis 3 cannot be excited, must be 0 to 2"):
        image.excite(Drive.VOLTAGE, 3)
