"""Fixtures of the tests that open an audio line."""

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile

from firmware_sim.audio import SteppedStream, Stream
from tests.vibractl.audio_rig import RATE
from vibractl.config import RigConfig


@pytest.fixture
def files(tmp_path: Path) -> list[str]:
    """Two impulse responses, each to two accelerometers, that ring for 20 ms."""
    rng = np.random.default_rng(1)
    names = []
    for name in ("one", "two"):
        ring = np.exp(-np.arange(882) / 150)[:, None] * rng.standard_normal((882, 2))
        names.append(str(tmp_path / f"{name}.wav"))
        soundfile.write(names[-1], 0.02 * ring, RATE, subtype="FLOAT")
    return names


@pytest.fixture
def card(monkeypatch: pytest.MonkeyPatch) -> list[SteppedStream]:
    """Collect the simulated streams that are opened, to have faults put into them."""
    opened: list[SteppedStream] = []
    from_config = Stream.from_config

    def constructor(config: RigConfig) -> Callable[..., Stream]:
        make = functools.partial(from_config(config))

        def keep(*args: Any, **keywords: Any) -> Stream:
            opened.append(make(*args, **keywords))
            return opened[-1]

        return keep

    monkeypatch.setattr(Stream, "from_config", constructor)
    return opened
