"""Vibrators side by side: each is itself, hears its neighbours late and weakly, and all are heard afar."""

import numpy as np
import pytest

from firmware_sim.plants.vibrator import VibratorPlant
from firmware_sim.plants.vibrator_array import CHUNK, VibratorArrayPlant

RATE = 44_100
SILENT = {"drift": 0.0, "noise": -300.0, "hum": -300.0, "far_field_noise": -400.0}


def noise(frames: int, width: int) -> np.ndarray:
    return np.random.default_rng(3).standard_normal((frames, width))


def driven(drive: np.ndarray, frames: int = 0, **options: object) -> tuple[np.ndarray, np.ndarray]:
    """Return response and far field to a drive from rest, in one piece or in pieces of `frames`."""
    plant = VibratorArrayPlant(RATE, **{"vibrators": drive.shape[1] // 2} | options)
    response, far_field = np.full(drive.shape, np.nan), np.full((len(drive), plant.hydrophones), np.nan)
    for start in range(0, len(drive), frames or len(drive)):
        piece = slice(start, start + (frames or len(drive)))
        plant.run(drive[piece], response[piece], far_field[piece])
    return response, far_field


def transfer_matrix(vibrators: int, **options: object) -> np.ndarray:
    """Return the linear array's response, 15 to 650 Hz, shape (bins, 2 vibrators, 2 vibrators)."""
    columns = []
    for coil in range(2 * vibrators):
        drive = np.zeros((2 * RATE, 2 * vibrators))
        drive[0, coil] = 1.0
        response, _ = driven(drive, nonlinearity=0.0, **(SILENT | options))
        columns.append(np.fft.rfft(response, axis=0)[30:1300])
    return np.stack(columns, axis=-1)


def level(part: np.ndarray, whole: np.ndarray) -> float:
    return float(20 * np.log10(np.linalg.norm(part) / np.linalg.norm(whole)))


@pytest.mark.parametrize("options", [{}, {"seed": 5, "medium": "water", "trend": 0.02, "nonlinearity": 1.6}])
def test_one_vibrator_in_an_array_is_the_vibrator_bit_for_bit(options: dict[str, object]) -> None:
    drive, expected = noise(9_000, 2), np.zeros((9_000, 2))
    VibratorPlant(RATE, **options).run(drive, expected)
    assert driven(drive, **options)[0].tobytes() == expected.tobytes()


def test_without_crosstalk_every_vibrator_is_alone() -> None:
    drive = noise(5_000, 6)
    response, _ = driven(drive, seed=4, crosstalk=-400.0)
    for index in range(3):
        alone, expected = np.ascontiguousarray(drive[:, 2 * index : 2 * index + 2]), np.zeros((5_000, 2))
        VibratorPlant(RATE, seed=4 + 1000 * index).run(alone, expected)
        np.testing.assert_allclose(response[:, 2 * index : 2 * index + 2], expected, atol=1e-12)


@pytest.mark.parametrize(("medium", "crosstalk"), [("air", -20.0), ("water", -20.0), ("water", -30.0)])
def test_neighbours_are_heard_at_the_level_asked_for(medium: str, crosstalk: float) -> None:
    matrix = transfer_matrix(2, medium=medium, crosstalk=crosstalk)
    for here, there in ((slice(0, 2), slice(2, 4)), (slice(2, 4), slice(0, 2))):
        assert level(matrix[:, here, there], matrix[:, there, there]) == pytest.approx(crosstalk, abs=2)


def test_who_is_twice_as_far_is_heard_half_as_loud_and_twice_as_late() -> None:
    matrix = transfer_matrix(3, spacing=10.0, distance=20.0)
    next_to, beyond = (level(matrix[:, shells, :2], matrix[:, :2, :2]) for shells in (slice(2, 4), slice(4, 6)))
    assert next_to - beyond == pytest.approx(6, abs=0.5)
    drive = np.zeros((4_000, 6))
    drive[0, 0] = 1.0
    response, _ = driven(drive, spacing=10.0, distance=20.0, **SILENT)
    first = [int(np.argmax(np.abs(response[:, shell]) > 1e-12)) for shell in (0, 2, 4)]
    assert first[1] - first[0] == round(10 / 343 * RATE)
    assert first[2] - first[0] == round(20 / 343 * RATE)


def test_the_far_field_is_the_volume_acceleration_of_all_shells_over_their_distance_and_later() -> None:
    drive = noise(4_000, 4)
    response, far_field = driven(drive, medium="water", hydrophones=2, **SILENT)
    places = np.array([[10.0, 0.0], [10 / np.sqrt(2), 10 / np.sqrt(2)]])
    expected = np.zeros((4_000, 2))
    for hydrophone, place in enumerate(places):
        for shell, (x, y) in enumerate([(-0.5, -1.5), (0.5, -1.5), (-0.5, 1.5), (0.5, 1.5)]):
            apart = np.hypot(place[0] - x, place[1] - y)
            late = round(apart / 1500 * RATE)
            expected[late:, hydrophone] += 1000 * 0.15 / (4 * np.pi * apart) * response[: 4_000 - late, shell]
    np.testing.assert_allclose(far_field, expected, atol=1e-9)
    assert np.std(far_field) > 1


def test_a_hydrophone_has_its_own_noise_and_hears_none_of_the_accelerometers() -> None:
    rest = np.zeros((4 * RATE, 4))
    _, far_field = driven(rest, medium="water", noise=0.0, hum=0.0, far_field_noise=-60.0)
    places = np.array([[x, y] for y in (-1.5, 1.5) for x in (-0.5, 0.5)])
    loud = 10 * (1000 * 0.15 / (4 * np.pi * np.linalg.norm([10, 0] - places, axis=1))).sum()
    assert np.std(far_field) == pytest.approx(1e-3 * loud, rel=0.02)


@pytest.mark.parametrize("frames", [64, CHUNK + 1, 441])
def test_it_answers_the_same_in_one_piece_and_in_many(frames: int) -> None:
    drive = noise(30_000, 4)
    options = {"hydrophones": 2, "spacing": 8.0, "distance": 20.0}
    for whole, pieces in zip(driven(drive, **options), driven(drive, frames, **options), strict=True):
        assert whole.tobytes() == pieces.tobytes()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"vibrators": 0}, "simulator.options.vibrators is 0, must be a whole number 1 to 16"),
        ({"crosstalk": 0.0}, "simulator.options.crosstalk is 0.0, must be -400 to -6 dB"),
        ({"hydrophones": 1.5}, "simulator.options.hydrophones is 1.5, must be a whole number 1 to 16"),
        ({"noise": 5.0}, "simulator.options.noise is 5.0, must be -400 to 0 dB"),
        (
            {"vibrators": 8},
            "simulator.options.distance is 10 m, must be >= 11.5 m: 8 vibrators 3 m apart are in the way",
        ),
    ],
)
def test_an_option_out_of_range_is_refused_by_name(options: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=f"^{words.replace('.', '[.]')}$"):
        VibratorArrayPlant(RATE, **options)
