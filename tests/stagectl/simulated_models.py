"""Models of the simulated stage of seed 1, from the inner loops' references, as its step responses give them."""

from pathlib import Path

from stagectl.model_file import write_model
from stagectl.models import InnovationModel
from tests.stagectl.linear_stage import lagging, sampled

MODES = {
    "x": [(61.22, 0.0042, 3.292), (96.82, 0.0166, 0.553), (133.32, 0.0080, 1.087)],
    "y": [(71.68, 0.0096, 3.308), (129.10, 0.0077, 1.455)],
    "z": [(80.43, 0.0077, 4.529)],
}
"""Natural frequency (Hz), damping ratio, and part of the gain at rest (m/m) of each mode below 150 Hz."""
LAG = 700.0
"""Hz: inner loop, delay of the sensors and all faster modes together."""


def simulated_model(axis: str) -> InnovationModel:
    """Return the model of an axis, orders 7, 5 and 3."""
    return lagging(sampled(MODES[axis]), LAG)


def write_models(folder: Path) -> list[Path]:
    """Write a model file an axis into a folder, and return them."""
    files = [folder / f"{axis}.h5" for axis in "xyz"]
    for axis, file in zip("xyz", files, strict=True):
        write_model(file, simulated_model(axis))
    return files
