"""Models of the simulated stage of seed 1, from the inner loops' references, made by hand from its modes."""

from pathlib import Path

import numpy as np

from calibration.state_space.model import InnovationModel
from stagectl.models.model_file import write_model
from stagectl.stage.measured_response import MeasuredResponse
from tests.stagectl.experiments.piezo.linear_stage import lagging, sampled

MODES = {
    "x": [(57.2, 0.0101, 3.638), (95.8, 0.0184, 0.469), (130.8, 0.0122, 0.835)],
    "y": [(67.2, 0.0165, 3.621), (126.0, 0.0128, 1.158)],
    "z": [(74.1, 0.0172, 4.513)],
}
"""Natural frequency (Hz), damping ratio, and part of the gain at rest (m/m) of each mode below 150 Hz."""
LAG = 600.0
"""Hz: amplifier, delay of the sensors and all faster modes together."""


def simulated_model(axis: str) -> InnovationModel:
    """Return the model of an axis, orders 7, 5 and 3."""
    return lagging(sampled(MODES[axis]), LAG)


def write_models(folder: Path) -> list[Path]:
    """Write a model file an axis into a folder, and return them."""
    files = [folder / f"{axis}.h5" for axis in "xyz"]
    for axis, file in zip("xyz", files, strict=True):
        model = simulated_model(axis)
        write_model(file, model, heard(model))
    return files


def heard(model: InnovationModel) -> MeasuredResponse:
    """Return what chirps hear of the plant that a model is of, where a laser sees as its sensor does."""
    cells = np.arange(1.0, 800.0)
    return MeasuredResponse(cells, model.frequency_response(cells)[:, 0, 0], np.zeros(len(cells), complex))
