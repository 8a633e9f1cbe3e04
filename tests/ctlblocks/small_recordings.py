"""A recording of two channels, with what it takes to change or compare it."""

import numpy as np

from ctlblocks.recording import Recording

NOISE = np.random.default_rng(2).standard_normal((50, 2))


def recording(dtype: str = "float32", **changed: object) -> Recording:
    fields: dict[str, object] = {
        "names": ("drive_1", "acceleration, left"),
        "units": ("V", "m/s^2"),
        "rate": 44_100.0,
        "data": NOISE.astype(dtype),
        "provenance": {"rig": "bench å", "comment": 'say "hello",\nthen go'},
    }
    return Recording(**(fields | changed))  # type: ignore[arg-type]


def same(one: Recording, other: Recording) -> bool:
    return (one.names, one.units, one.rate, one.provenance, one.data.dtype) == (
        other.names,
        other.units,
        other.rate,
        other.provenance,
        other.data.dtype,
    ) and one.data.tobytes() == other.data.tobytes()
