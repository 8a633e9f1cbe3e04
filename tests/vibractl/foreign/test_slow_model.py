"""What a model expects of a drive, looked at slower, and where it says nothing."""

import json
from dataclasses import replace

import numpy as np

from tests.vibractl.linear_rig import linear_matrix
from vibractl.foreign.slow_model import SlowModel
from vibractl.transfer_matrix import GAPS

RATE, SAMPLES = 44_100 / 32, 4_096
TIME = np.arange(SAMPLES) / RATE


def expected(frequency: float, **words: str) -> float:
    """Return the largest response that is expected of a tone on the first coil."""
    drive = np.stack((np.sin(2 * np.pi * frequency * TIME) * np.hanning(SAMPLES), 0 * TIME), axis=1)
    matrix = linear_matrix()
    model = SlowModel(replace(matrix, provenance={**matrix.provenance, **words}), SAMPLES, RATE)
    return float(np.abs(model.expected(drive)).max())


def test_a_tone_comes_out_as_the_matrix_says() -> None:
    matrix = linear_matrix()
    gain = np.abs(matrix.response[np.argmin(np.abs(matrix.frequency - 200.0)), :, 0]).max()
    assert abs(expected(200.0) / gain - 1) < 0.05


def test_nothing_is_expected_outside_of_its_band_and_in_its_gaps() -> None:
    assert expected(5.0) < 1e-3 * expected(60.0)
    gap = {GAPS: json.dumps([[55.0, 65.0, "too much noise"]])}
    assert expected(60.0, **gap) < 1e-3 * expected(60.0)
    assert abs(expected(80.0, **gap) / expected(80.0) - 1) < 1e-3
