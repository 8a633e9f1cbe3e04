"""A band whose response is another one in every shot: it is frozen and told of once, and the rest goes on."""

import numpy as np
from scipy.ndimage import binary_dilation

from tests.vibractl.learning.line_plant import LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation, Watch
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.decision import Decision
from vibractl.learning.law import Law
from vibractl.learning.shot import Shot

BAND = (300.0, 310.0)
NEAR = 15
"""Lines to each side that the band's restlessness reaches."""


class RestlessPlant(LinePlant):
    """From shot 5 on, turns its response in `BAND` by another 100 degrees with every shot."""

    made = 0

    def __init__(self, response: np.ndarray, law: Law) -> None:
        super().__init__(response, law, distortion=0.05)
        self.band = (law.matrix.frequency >= BAND[0]) & (law.matrix.frequency <= BAND[1])

    def shot(self, drive: np.ndarray) -> Shot:
        if self.made >= 5:
            self.response[self.band] *= np.exp(1.75j)
        self.made += 1
        return super().shot(drive)


def test_a_band_that_will_not_converge_is_frozen_and_told_of_once_and_the_rest_goes_on() -> None:
    true = modal(2, 2)
    law = law_of(matrix_of(true))
    algorithm = Algorithm(law, Adaptation(), Watch(on=True, rounds=1), -40.0)
    plant, told, drives = RestlessPlant(true, law), list[Decision](), list[np.ndarray]()
    for _ in range(40):
        algorithm.step(plant.shot(algorithm.lines))
        told += algorithm.decisions
        drives.append(algorithm.lines)
    assert {decision.event for decision in told} == {"divergence", "reidentify", "reidentified", "frozen"}
    at_first = [decision.fields["at_hz"] for decision in told if decision.event == "divergence"]
    frozen = np.zeros(len(law.reference), dtype=bool)
    for number, decision in enumerate(told):
        if decision.event == "frozen":
            assert not any(
                _within(later.fields.get("at_hz"), decision.fields["band_hz"]) for later in told[number + 1 :]
            )
            frozen |= _inside(law, decision.fields["band_hz"])
    assert len(at_first) <= 4
    assert np.mean(frozen[plant.band]) > 0.9
    np.testing.assert_array_equal(drives[-1][frozen], drives[-2][frozen])
    heard = binary_dilation(plant.band, iterations=NEAR)
    elsewhere = np.abs(law.reference - plant.shot(algorithm.lines).response)[~frozen & ~heard]
    assert elsewhere.max() < 2e-3 * np.abs(law.reference).max()


def _inside(law: Law, band: list[float]) -> np.ndarray:
    return (law.matrix.frequency >= band[0]) & (law.matrix.frequency <= band[1])


def _within(at: float | None, band: list[float]) -> bool:
    return at is not None and band[0] <= at <= band[1]
