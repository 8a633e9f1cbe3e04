"""G_M and G_K from one trial: what made the data is found again, and a trial without force is refused."""

import numpy as np
import pytest

from calibration.milling.process_fit import fit_process
from stagectl.robot.milling.zero_phase import filtered
from tests.stagectl.robot.milling.trial_models import RATE, process, square


def test_a_linear_process_is_found_again_in_noise() -> None:
    true, seen = process(), square(rest=0.5, seconds=4.0)
    force = filtered(seen, RATE, true.force.frequency_response)
    deflection = true.deflection(force, RATE)
    rng = np.random.default_rng(1)
    noisy = [each + size * rng.standard_normal(each.shape) for each, size in (
        (seen, 1e-6), (deflection, 1e-6), (force, 0.02))]  # fmt: skip
    found = fit_process(*noisy, np.ones(len(seen), bool), RATE)
    assert found.process.compliance_fresh.min() > 80.0
    assert found.process.force_fresh.min() > 80.0
    again = found.process.model.deflection(force - force.mean(axis=0), RATE)
    wanted = deflection - deflection.mean(axis=0)
    inside = slice(500, -500)
    assert np.abs(again - wanted)[inside].mean() < 0.1 * np.abs(wanted)[inside].mean()


def test_a_trial_in_which_nothing_was_milled_is_refused() -> None:
    seen = square(rest=0.2, seconds=0.5)
    with pytest.raises(ValueError, match="the force never changes: nothing was milled"):
        fit_process(seen, 0 * seen, 0 * seen, np.ones(len(seen), bool), RATE)
