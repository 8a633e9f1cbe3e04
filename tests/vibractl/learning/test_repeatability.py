import numpy as np
import pytest

from tests.vibractl.learning.line_plant import law_of, matrix_of, modal
from vibractl.config import Adaptation, Watch
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.repeatability import KEPT, Repeatability
from vibractl.learning.shot import Shot

LIMIT, NOISE = 1e-3, 1e-9
LAW = law_of(matrix_of(modal(2, 2)))
LINES = LAW.matrix.frequency
JUDGED = (LAW.active > 0) & (LINES >= 100.0)


def followed(shots: int, moves_db: float = -200.0, drift_hz: float = 210.0, step: float = 0.0) -> Repeatability:
    """Follow a machine whose response walks around a line by so much, dB re the limit, while its drive is changed."""
    algorithm = Algorithm(LAW, Adaptation(), Watch(), -40.0)
    rng, shape = np.random.default_rng(1), (len(LINES), 2)
    size = LIMIT * 10 ** (moves_db / 20) * np.exp(-0.5 * ((LINES - drift_hz) / 5) ** 2)[:, None]
    walked, drive = np.zeros(shape, complex), algorithm.law.start.copy()
    repeats = Repeatability(algorithm, JUDGED, LIMIT)

    def drawn() -> np.ndarray:
        pair = rng.standard_normal((2, *shape)) / np.sqrt(2)
        made: np.ndarray = pair[0] + 1j * pair[1]
        return made

    for _ in range(shots):
        walked = walked + size * drawn()[:1]
        drive = drive + step * np.abs(drive) * drawn()
        response = (LAW.matrix.response @ drive[..., None])[..., 0] + walked + np.sqrt(NOISE) * drawn()
        repeats.take(Shot(drive, response, np.full(shape, NOISE)))
    return repeats


@pytest.mark.parametrize("moves_db", [-12.0, 0.0, 9.0])
def test_it_says_by_how_much_a_machine_moves_and_where(moves_db: float) -> None:
    floor = followed(KEPT + 1, moves_db).floor
    assert floor is not None
    assert floor.change == pytest.approx(moves_db, abs=4.0)
    assert floor.frequency == pytest.approx(210.0, abs=12.0)
    assert floor.explained < -100


def test_a_drive_that_changes_is_no_machine_that_moves() -> None:
    floor = followed(KEPT + 1, 0.0, step=0.3).floor
    assert floor is not None
    assert floor.change == pytest.approx(0.0, abs=4.0)
    assert floor.explained == pytest.approx(-33.6, abs=3.0)  # which a wrong model would leave as much of


def test_where_there_is_no_limit_it_does_not_count() -> None:
    floor = followed(KEPT + 1, 20.0, drift_hz=60.0).floor
    assert floor is None or floor.change < -20


def test_noise_is_no_machine_that_moves() -> None:
    repeats = followed(3 * KEPT)
    assert repeats.floor is None


def test_too_few_shots_say_nothing() -> None:
    assert followed(KEPT // 2, 0.0).floor is None
    assert followed(KEPT // 2 + 1, 0.0).floor is not None


def test_shots_for_something_else_do_not_count() -> None:
    algorithm = Algorithm(LAW, Adaptation(), Watch(), -40.0)
    repeats = Repeatability(algorithm, JUDGED, LIMIT)
    shot = Shot(algorithm.law.start, algorithm.law.reference, np.zeros((len(LINES), 2)))
    for number in range(2 * KEPT):
        repeats.take(Shot(shot.drive, shot.response * (1 + number), shot.noise), counts=False)
    assert repeats.floor is None
