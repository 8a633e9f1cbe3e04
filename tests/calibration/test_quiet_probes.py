"""Probes of a quiet calibration: safe on the most sensitive rig, and loud enough on one that hardly answers."""

import numpy as np
import pytest

from calibration.emission_limit import EmissionLimit
from calibration.multisine import Design
from calibration.multisine_estimate import Spectra
from calibration.quiet_multisine import scout_design
from calibration.quiet_probes import MOST, MOST_LOW, MOST_STUCK, PEAK, SHARE, STRONGEST, Probes, UnheardError
from rigkit import config as rig_file
from vibractl.config import RigConfig

RIG = rig_file.load(None, RigConfig, ["characterisation.quiet=true", "reference.signal=chirp:40:90:5"])
LIMIT = EmissionLimit.of(RIG)


def resonant(frequency: np.ndarray, low: float, peak: float, at: float = 300.0) -> np.ndarray:
    """Return |G|, m/s^2 per V, of a rig that is `low` below 100 Hz and rises to `peak` at one resonance."""
    above = peak / (1 + ((frequency - at) / 5) ** 2)
    size: np.ndarray = np.where(frequency < 100, low, np.maximum(above, 0.01 * low))
    return size


class Rig:
    """Answers probes; `emitted` is the loudest line of any so far for which the limit holds, re the limit."""

    def __init__(self, low: float, peak: float, noise: float = 1e-6, hum: float = 0.0, ships: float = 1.0) -> None:
        self._low, self._peak, self._noise, self._hum, self._ships = low, peak, noise, hum, ships
        self._rng, self.emitted, self.probes = np.random.default_rng(3), 0.0, 0

    def heard(self, design: Design) -> Spectra:
        """Return one probe as it is heard, louder ambience than in the silence before it included."""
        self.probes += 1
        count, first = design.bins[-1] - design.bins[0] + 1, int(design.bins[0])
        frequency = (first + np.arange(count)) * design.rate / design.period
        answer = np.zeros((count, 2), complex)
        answer[design.bins - first] = design.amplitude * resonant(design.frequency, self._low, self._peak)[:, None]
        holds = ~LIMIT.is_free(frequency)
        self.emitted = max(self.emitted, float(np.abs(answer[holds]).max() / LIMIT.tone))
        silence, noise = (self._ambience(count, frequency) for _ in range(2))
        return Spectra(np.zeros((1, count, 2), complex), (answer + self._ships * noise)[None], silence, first)

    def _ambience(self, count: int, frequency: np.ndarray) -> np.ndarray:
        noise = self._rng.standard_normal((count, 2)) + 1j * self._rng.standard_normal((count, 2))
        noise *= self._noise * LIMIT.tone / np.sqrt(2)
        noise[np.isin(frequency, (50.0, 150.0, 250.0))] += self._hum * LIMIT.tone
        return noise


def probed(rig: Rig) -> Probes:
    probes = Probes(scout_design(RIG), LIMIT)
    while not probes.done:
        probes.take(rig.heard(probes.design))
    return probes


@pytest.mark.parametrize("gain", [1e5, 300.0, 1.0, 0.3])
@pytest.mark.parametrize("ratio", [0.1, 1.0, 20.0])
def test_the_scout_is_at_its_share_of_the_limit_whatever_the_gain(gain: float, ratio: float) -> None:
    low = gain / max(ratio, 1.0)
    rig = Rig(low, ratio * low)
    probes = probed(rig)
    scout = probes.scout
    rig.heard(scout)
    assert rig.emitted == pytest.approx(SHARE, rel=0.02)
    assert rig.probes - 1 <= MOST_LOW + MOST
    assert scout.records == 4
    assert probes.design.records == 1


def test_no_probe_is_over_the_limit_on_the_most_sensitive_rig() -> None:
    rig = Rig(STRONGEST / PEAK, STRONGEST)
    probed(rig)
    assert rig.emitted <= SHARE * 1.01


@pytest.mark.parametrize("hum", [0.0, 3.0])
@pytest.mark.parametrize("ships", [1.0, 10.0])
def test_ambience_that_grows_while_it_is_probed_is_not_taken_for_the_rig(hum: float, ships: float) -> None:
    """Over the silence before it a ship is 20 dB; the lines between the excited ones hear it as well."""
    rig = Rig(1.0, 10.0, noise=0.02, hum=hum, ships=ships)
    rig.heard(probed(rig).scout)
    assert 0.3 * SHARE < rig.emitted <= 1.0


def test_a_rig_that_sticks_where_there_is_no_limit_is_heard_above() -> None:
    rig = Rig(1e-4, 1.0, noise=0.02)
    rig.heard(probed(rig).scout)
    assert 0.1 * SHARE < rig.emitted <= 1.0


def test_a_rig_that_answers_nothing_is_refused() -> None:
    rig = Rig(1e-9, 1e-9, noise=0.01)
    with pytest.raises(UnheardError, match=r"drives of .* V per bin reach no response; are amplifier and sensors on"):
        probed(rig)
    assert rig.probes == MOST_LOW + MOST_STUCK


def test_a_band_above_100_hz_begins_with_all_lines() -> None:
    rig = RIG.model_copy(update={"characterisation": RIG.characterisation.model_copy(update={"band": (150.0, 600.0)})})
    probes = Probes(scout_design(rig), LIMIT)
    assert probes.design.amplitude.min() > 0
    assert probes.design.amplitude.max() == pytest.approx(SHARE * LIMIT.tone / STRONGEST)
