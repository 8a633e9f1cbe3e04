"""Damaged pockets, paths and events of a run, and what each must be read as if it is."""

import json
import random
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from rigkit.run_folder import EVENTS, read_events
from stagectl.planning.pocket import check, plan
from stagectl.planning.pocket_file import read_path, read_pocket
from stagectl.planning.problem import Pocket, PocketFault
from tests.fuzz.judge import is_accepted
from tests.fuzz.mutation import mutated, of_text
from tests.stagectl.planning.pockets import EXAMPLE

HURTFUL = (
    b"[" * 5_000, b'{"a":' * 5_000, b"NaN", b"-Infinity", b"1e999", b'"\\ud800"', b"9" * 30, b"9" * 5_000,
    b'"rows": 5, "rows": 6', b"\xff", b"\xc0\x80",
)  # fmt: skip
"""What JSON can hold, or is taken for JSON by some, and no file of ours may."""
SOUND = (
    json.dumps(EXAMPLE, indent=1),
    json.dumps(plan(Pocket.from_dict(EXAMPLE), "exact"), indent=1),
    "".join(json.dumps({"time": "2020-01-01", "event": "shot", "shot": n, "text": "é"}) + "\n" for n in range(4)),
)


def cases(folder: Path) -> Callable[[int], bool]:
    """Return what reads the damaged file of a number, and says whether it was accepted."""
    kinds = (_pocket, PocketFault), (_path, PocketFault), (_events, ValueError)
    texts = [text.encode() for text in SOUND]

    def case(number: int) -> bool:
        chance = random.Random(number)
        kind = chance.randrange(len(kinds))
        content = mutated(texts[kind], chance, texts, of_text)
        if chance.random() < 0.2:
            place = chance.randrange(len(content) + 1)
            content = content[:place] + chance.choice(HURTFUL) + content[place:]
        (folder / EVENTS).write_bytes(content)
        read, own = kinds[kind]
        return is_accepted(partial(read, folder), partial(_check, content, kind), own)

    return case


def _pocket(folder: Path) -> list[Any]:
    read = read_pocket(folder / EVENTS)
    assert read.types
    return [vars(read)]


def _path(folder: Path) -> list[Any]:
    read = read_path(folder / EVENTS)
    assert check(Pocket.from_dict(EXAMPLE), read).total >= 0.0
    return read


def _events(folder: Path) -> list[Any]:
    return read_events(folder)


def _check(content: bytes, kind: int, read: list[Any]) -> None:
    """Compare with what Python's own reader makes of it; of a pocket, what is said alone."""
    if kind == 2:  # a line each; the last one may be cut short
        assert read == [json.loads(line) for line in content.split(b"\n")[:-1]]
        return
    said = json.loads(content.decode("utf-8-sig"))
    assert said == (read if kind == 1 else {key: read[0][key] for key in said})
