"""The robot's velocity model for force control: from the velocity asked of it to its velocity, judged on fresh data."""

from dataclasses import dataclass, replace

import numpy as np

from calibration.fit_measures import Fit, fit
from calibration.one_thread import on_one_thread
from calibration.state_space.model import InnovationModel
from calibration.subspace.identify import identify
from ctlblocks.recording import Recording
from rigkit.provenance import now, software

SIGNALS = ("velocity_reference", "velocity")
"""Channels of a record, m/s."""
HELD_BACK = 0.3
"""Share of the samples, at the end, by which the model is judged."""


@dataclass(frozen=True, eq=False)
class Velocity:
    """A velocity model and how well it does.

    Parameters
    ----------
    model : InnovationModel
    own, fresh : Fit
        On the part it was identified from, and on the validation data.
    """

    model: InnovationModel
    own: Fit
    fresh: Fit


@on_one_thread
def identify_velocity(record: Recording, order: int = 3) -> Velocity:
    """Identify the model by N4SID, without a direct term: a reference takes a sample at least.

    Parameters
    ----------
    record : Recording
        With the channels `SIGNALS`.
    order : int

    Raises
    ------
    ValueError : a channel that is missing or never changes, or too few samples for the order.

    Source
    ------
    Sörnmo 2015, eqs. (7.1) and (7.2), and sec. 7.2.
    """
    data = np.asarray(record.select(SIGNALS).data, float)
    for name, signal in zip(SIGNALS, data.T, strict=True):
        if not np.ptp(signal) > 0:
            raise ValueError(f"channel {name!r} never changes: it has nothing to identify from")
    cut = round(len(data) * (1.0 - HELD_BACK))
    drive, response = data[:, :1], data[:, 1:]
    found = identify(drive[:cut], response[:cut], record.rate, order=order, method="n4sid", direct=False, delay=0)
    drive, response = drive - found.input_offset, response - found.output_offset
    words = {**record.provenance, "computed": now(), "software": software(), "method": "n4sid", "samples": str(cut)}
    model = replace(
        found.model,
        provenance=words,
        input_names=SIGNALS[:1],
        output_names=SIGNALS[1:],
        input_units=("m/s",),
        output_units=("m/s",),
    )
    own = fit(model, [drive[:cut]], [response[:cut]], fitted=model.order)
    return Velocity(model, own, fit(model, [drive[cut:]], [response[cut:]]))
