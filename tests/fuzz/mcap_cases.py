"""Damaged MCAP logs, and what each must be read as if it is."""

import random
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType, IndexType

from ctlblocks.recording import Recording, RecordingError
from rigkit.foreign_record import read_signals
from tests.fuzz.judge import is_accepted
from tests.fuzz.mutation import mutated, of_bytes
from tests.rigkit.mcap_logs import json_log, protobuf_log, ros2_log, times

FEW = 40
"""Messages of a file."""
NUMBERS = np.round(np.random.default_rng(2).normal(size=FEW), 3)
OPTIONS: tuple[dict[str, Any], ...] = (
    {},
    {"use_chunking": False},
    {"compression": CompressionType.LZ4},
    {"compression": CompressionType.NONE, "enable_crcs": False},
    {"compression": CompressionType.NONE, "index_types": IndexType.NONE, "enable_crcs": False},
)


def cases(folder: Path) -> Callable[[int], bool]:
    """Return what reads the damaged log of a number, and says whether it was accepted."""
    path = folder / "log.mcap"
    messages = [
        (time, {"a": number, "b": [1, number]}) for time, number in zip(times(FEW, 100.0), NUMBERS, strict=True)
    ]
    sound = [json_log(path, {"/x": messages}, **options).read_bytes() for options in OPTIONS]
    sound += [protobuf_log(path, list(NUMBERS), 100.0).read_bytes()]
    sound += [ros2_log(path, np.tile(NUMBERS, (2, 1)).T, 100.0).read_bytes()]

    def case(number: int) -> bool:
        chance = random.Random(number)
        path.write_bytes(mutated(sound[number % len(sound)], chance, sound, of_bytes))
        return is_accepted(lambda: read_signals(path), partial(_check, number), RecordingError)

    return case


def _check(_number: int, read: Recording) -> None:
    """Look at rate and length: in a file without checksums another number is another one."""
    assert 0 < read.rate < np.inf, f"{read.rate} samples/s"
    assert np.isfinite(read.data).all(), "NaN"
    assert 2 <= len(read.data) <= FEW, f"{read.data.shape} for {FEW}"
