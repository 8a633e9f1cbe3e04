"""Whether the coils answer as they did when the model was measured."""

import numpy as np

from rigkit.verdict import Verdict
from vibractl.doctor.coils import Answers
from vibractl.learning.changed_rig import change_of, unexplained
from vibractl.transfer_matrix import TransferMatrix

MODEL = "model"
"""The check's name."""
POOR = 0.5
"""Of the response, rms, from which a model that nothing explains is a warning."""
_LIMIT = "the channels that were calibrated"


def model_verdict(found: Answers, matrix: TransferMatrix, late: float) -> Verdict:
    """Compare what came back from each coil with a model of this rig.

    Parameters
    ----------
    found : Answers
    matrix : TransferMatrix
    late : float, s
        Round trip that is in the answers.
    """
    inside = matrix.covers(found.frequency)
    frequency = found.frequency[inside]
    if not len(frequency):
        measured = f"the model has no bin from {found.frequency[0]:.0f} to {found.frequency[-1]:.0f} Hz"
        return Verdict(MODEL, "warn", measured, _LIMIT, "nothing can be compared")
    heard = found.response[inside] * np.exp(2j * np.pi * frequency * late)[:, None, None]
    model = matrix.at(frequency).response
    coils = model.shape[2]
    drive = np.repeat(np.eye(coils), len(frequency), axis=0)  # one coil after the other
    stacked = np.concatenate([heard[:, :, coil] for coil in range(coils)])
    tiled = np.tile(model, (coils, 1, 1))
    off = unexplained(tiled, drive, stacked)
    change = change_of(tiled, drive, stacked, np.tile(frequency, coils))
    if change is not None:
        advice = "set it right, or measure a new model with `calibrate vibrator`"
        return Verdict(MODEL, "fail", change.text, _LIMIT, advice, off, "1", {"left": change.left})
    measured = f"off by {off:.2f} of the response"
    if off > POOR:
        advice = "the response to a weak sweep differs from the calibrated one: calibrate at the working level"
        return Verdict(MODEL, "warn", f"{measured}, by no change of channels", _LIMIT, advice, off, "1")
    return Verdict(MODEL, "pass", f"{measured}: the channels that were calibrated", _LIMIT, "", off, "1")
