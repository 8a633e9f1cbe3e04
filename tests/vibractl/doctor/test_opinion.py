"""The verdicts that no fault of the simulated card brings about, and the limits themselves."""

import numpy as np
import pytest

from vibractl.config import Quality, RigConfig
from vibractl.doctor.chain import Clock
from vibractl.doctor.coils import Answers
from vibractl.doctor.opinion import (
    clock_verdict,
    distortion_verdict,
    hum_verdict,
    noise_verdict,
    polarity_verdict,
    recordings_verdict,
)
from vibractl.doctor.silence import Hum


@pytest.mark.parametrize(
    ("ppm", "slip", "quality", "grade", "advice"),
    [
        (0.05, 0.0, 1.0, "pass", ""),
        (-0.5, 0.1, 1.0, "warn", "word clock"),
        (50.0, 0.1, 0.98, "fail", "word clock"),
        (0.0, 0.0, 0.98, "fail", "samples are lost"),
        (0.0, 0.3, 1.0, "fail", "samples are lost"),
        (np.nan, np.nan, 0.0, "fail", "samples are lost"),
    ],
)
def test_two_clocks_fail_from_1_ppm_and_lost_samples_always(
    ppm: float, slip: float, quality: float, grade: str, advice: str
) -> None:
    said = clock_verdict(Clock(np.array([0.0, 9.3]), np.zeros(2), 1e-6 * ppm, slip, quality))
    assert said.grade == grade
    assert advice in said.advice
    assert bool(said.advice) == (grade != "pass")


def test_late_callbacks_alone_are_a_warning() -> None:
    assert recordings_verdict(4, [], 3).grade == "warn"
    assert recordings_verdict(4, [], 0).grade == "pass"


@pytest.mark.parametrize(("objective", "grade"), [(-40.0, "pass"), (-45.0, "warn"), (-55.0, "fail")])
def test_a_tenth_of_the_objective_is_wanted(objective: float, grade: str) -> None:
    config = RigConfig(quality=Quality(objective=objective))
    said = distortion_verdict(-62.0, -90.0, 110.0, -20.0, config)
    assert said.grade == grade
    assert said.limit == f"{objective - 20:g} dB, a tenth of the objective"
    assert "most at 110 Hz" in said.measured
    assert "all of it noise" in distortion_verdict(-62.0, -64.0, 110.0, -20.0, config).measured


def test_hum_below_the_judged_band_is_told_and_not_judged() -> None:
    found = Hum(50.0, np.array([50.0, 100.0, 150.0]), np.array([-10.0, -80.0, -70.0]), np.array([1, 1, 2]))
    said = hum_verdict(found, RigConfig())
    assert (said.grade, said.value) == ("pass", -70.0)
    assert "below 100 Hz, not judged: -10.0 dB at 50 Hz" in said.measured
    assert said.detail == {"50_hz_db": -10.0, "100_hz_db": -80.0, "150_hz_db": -70.0}


def test_the_worst_octave_that_is_judged_decides_on_noise() -> None:
    level = np.array([[-20.0, -20.0], [-80.0, -52.0], [-70.0, -90.0]])
    said = noise_verdict(np.array([31.25, 125.0, 250.0]), level, RigConfig())
    assert (said.grade, said.value) == ("warn", -52.0)
    assert "125 Hz, response 2" in said.measured


def test_a_side_a_quarter_turn_apart_is_no_certain_polarity() -> None:
    response = np.zeros((4, 2, 2), complex)
    response[:, 0, 0], response[:, 1, 1] = 1.0, 1j
    found = Answers(np.array([15.0, 16.0, 17.0, 90.0]), response, np.full((2, 2), 40.0))
    assert polarity_verdict(found, True).grade == "warn"
    assert polarity_verdict(found, False).measured.startswith("not measured")
    assert polarity_verdict(Answers(found.frequency, response[:, :1, :1], np.ones((1, 1))), True).grade == "pass"
