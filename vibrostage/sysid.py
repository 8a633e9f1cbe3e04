"""Linear models from records, on plain arrays: state spaces in innovation form, and from frequency responses.

`identify` makes a model of inputs and outputs and judges it; `examine` looks at records first; `refine`, `arx` and
`identify_transfer_matrix` are prediction error methods; `identify_response` takes a frequency response with its
variances.  What is not called is not imported.

Examples
--------
::

    found = identify(u, y, rate=1000.0)      # (N, inputs), (N, outputs)
    print(found.summary())
    found.model.simulate(u)
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from calibration.frequency_domain import ResponseModel, identify_response
    from calibration.prediction_error import Arx, Refined, TransferMatrix, arx, identify_transfer_matrix, refine
    from calibration.state_space import InnovationModel
    from calibration.subspace import Examination, Identified, examine, identify

_PLACES = {
    "calibration.subspace": ("Examination", "Identified", "examine", "identify"),
    "calibration.state_space": ("InnovationModel",),
    "calibration.prediction_error": ("Arx", "Refined", "TransferMatrix", "arx", "identify_transfer_matrix", "refine"),
    "calibration.frequency_domain": ("ResponseModel", "identify_response"),
}

__all__ = [
    "Arx",
    "Examination",
    "Identified",
    "InnovationModel",
    "Refined",
    "ResponseModel",
    "TransferMatrix",
    "arx",
    "examine",
    "identify",
    "identify_response",
    "identify_transfer_matrix",
    "refine",
]


def __getattr__(name: str) -> Any:
    for place, names in _PLACES.items():
        if name in names:
            return getattr(import_module(place), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}; it has {', '.join(__all__)}")


def __dir__() -> list[str]:
    return sorted(__all__)
