"""Damaged rig files, and what each must be read as if it is."""

import math
import random
import tomllib
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from rigkit import config as rig_file
from rigkit.config import ConfigError, Section
from stagectl.config import StageConfig
from stagectl.robot.config import CellConfig
from tests.fuzz.judge import is_accepted
from tests.fuzz.mutation import mutated, of_text
from vibractl.config import RigConfig

MODELS: tuple[type[Section], ...] = (RigConfig, StageConfig, CellConfig)
TABLES = 3
"""Of a file in a case: more take long to parse, and a change then falls on few."""


def cases(folder: Path) -> Callable[[int], bool]:
    """Return what reads the damaged file of a number, and says whether it was accepted."""
    tables = {
        model: [f"[{text}".encode() for text in rig_file.dump(model()).split("[", 1)[1].split("\n[")]
        for model in MODELS
    }
    path = folder / "x.toml"

    def case(number: int) -> bool:
        chance = random.Random(number)
        model = chance.choice(MODELS)
        whole = b"\n".join(chance.sample(tables[model], TABLES))
        content = mutated(whole, chance, tables[model], of_text)
        path.write_bytes(content)
        return is_accepted(lambda: _read(path, model), partial(_check, content), ConfigError)

    return case


def _read(path: Path, model: type[Section]) -> BaseModel:
    """Read it with its paths made whole, and as it is written."""
    rig_file.load(path, model)
    return rig_file.load(path, model, as_written=True)


def _check(content: bytes, read: BaseModel) -> None:
    """Compare every value of the file with the one read, and look at every number."""
    _compare(tomllib.loads(content.decode("utf-8-sig")), read.model_dump(), "")
    assert rig_file.dump(read)


def _compare(said: Mapping[str, Any], found: Mapping[str, Any], path: str) -> None:
    for name, value in said.items():
        assert name in found, f"{path}{name} is passed over"
        if isinstance(value, dict):
            _compare(value, found[name], f"{path}{name}.")
            continue
        other = list(found[name]) if isinstance(found[name], tuple) else found[name]
        assert _is_read(value, other), f"{path}{name} is {other}, not {value}"
        for each in value if isinstance(value, list) else [value]:
            assert not isinstance(each, float) or math.isfinite(each), f"{path}{name} is {each}"


def _is_read(value: Any, other: Any) -> bool:
    """Whether what was read is what is said; an integer for a float, however long, is the nearest float."""
    if isinstance(value, list) and isinstance(other, list):
        return len(value) == len(other) and all(map(_is_read, value, other))
    return bool((float(value) if type(value) is int and isinstance(other, float) else value) == other)
