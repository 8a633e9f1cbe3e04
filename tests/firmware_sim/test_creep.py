"""The three laws of creep, against the formulas that they are named for."""

import numpy as np
import pytest

from firmware_sim.plants.creep import chain, logarithmic, power_law

TIME = np.geomspace(1e-3, 1e3, 61)


@pytest.mark.parametrize(("a_decade", "onset"), [(0.015, 1e-3), (0.03, 0.1)])
def test_logarithmic_creep_grows_by_the_same_in_each_decade(a_decade: float, onset: float) -> None:
    expected = a_decade * np.log10(1 + TIME / onset)
    np.testing.assert_allclose(logarithmic(a_decade, onset).after(TIME), expected, atol=2e-3 * a_decade)


@pytest.mark.parametrize("order", [0.05, 0.15, 0.3])
def test_a_fractional_dashpot_creeps_by_a_power_of_time(order: float) -> None:
    np.testing.assert_allclose(power_law(0.02, order).after(TIME), 0.02 * TIME**order, rtol=5e-3)


def test_a_chain_creeps_by_its_elements() -> None:
    expected = 0.02 * (1 - np.exp(-TIME / 0.3)) + 0.01 * (1 - np.exp(-TIME / 40))
    np.testing.assert_allclose(chain([0.3, 40.0], [0.02, 0.01]).after(TIME), expected, rtol=1e-12)
