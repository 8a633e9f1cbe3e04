"""Each mechanism of distortion is as loud on the simulated vibrator as its draw says."""

from dataclasses import replace

import numpy as np
import pytest

from firmware_sim.plants.exciter import Exciter, ExciterPlant, linear_response, without_distortion
from firmware_sim.plants.mode_drift import Drift
from firmware_sim.plants.reception import silent_reception
from firmware_sim.population import distortion
from firmware_sim.population.references import Wanted, inverse
from firmware_sim.population.steady_motion import HIGHEST, SteadyMotion
from firmware_sim.population.streams import Streams
from firmware_sim.population.vibrator_draw import draw_machine

RATE = 44_100
ROOT, LEVEL = 45.0, 5.0
"""Hz, of a sine, and m/s^2."""
SETTLED = 4
"""s."""


def silent_vibrator() -> Exciter:
    """Return a well damped lumped vibrator without distortion and surroundings."""
    whole: Exciter = draw_machine("lumped", 8).respond.args[0]  # type: ignore[attr-defined]
    coils = replace(whole.coils, clip=0.0, width=0 * whole.coils.width, offset=0 * whole.coils.offset)
    quiet = silent_reception(whole.reception.sensors)
    return replace(whole, coils=coils, elements=without_distortion(len(whole.elements)), reception=quiet, drift=Drift())


def loudest_overtone(exciter: Exciter, drive: np.ndarray) -> float:
    """Return the loudest overtone of a sine drive, complex amplitudes (coils,) V, dB re `LEVEL`."""
    time = np.arange((SETTLED + 1) * RATE) / RATE
    played = np.ascontiguousarray((drive * np.exp(2j * np.pi * ROOT * time)[:, None]).real)
    heard = np.zeros((len(time), len(exciter.structure.sensors)))
    ExciterPlant(exciter, RATE, 1).run(played, heard)
    lines = 2 / RATE * np.abs(np.fft.rfft(heard[SETTLED * RATE :], axis=0))
    orders = np.arange(2, 8) * int(ROOT)
    return float(20 * np.log10(lines[orders[orders <= HIGHEST]].max() / LEVEL))


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", distortion.MECHANISMS)
def test_a_mechanism_is_as_loud_as_its_draw_says(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    silent, wanted = silent_vibrator(), Wanted(ROOT, ROOT)
    monkeypatch.setattr(distortion, "_levels", lambda _: {name: 10 ** (-45 / 20)})
    motion = SteadyMotion(silent, wanted, LEVEL)
    loud, said = distortion.draw_distortion(Streams(4, "test"), silent, motion)
    assert said[0].value == pytest.approx(-45, abs=0.5)
    drive = LEVEL * inverse(linear_response(silent, np.array([ROOT]))).sum(axis=2)[0]
    assert loudest_overtone(silent, drive) < -110
    assert loudest_overtone(loud, drive) == pytest.approx(said[0].value, abs=2.0)


def test_a_vibrator_without_distortion_happens(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(distortion, "NONE", 1.0)
    silent = silent_vibrator()
    loud, said = distortion.draw_distortion(Streams(4, "test"), silent, SteadyMotion(silent, Wanted(40.0, 90.0), LEVEL))
    assert said == ()
    np.testing.assert_array_equal(loud.elements, silent.elements)
