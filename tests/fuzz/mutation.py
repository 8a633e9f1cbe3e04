"""Files with something wrong in them, the same ones each time: by a number, from files that are sound."""

import random
import struct
from collections.abc import Callable, Sequence

_WORDS = [
    struct.pack("<" + kind, value)
    for kind, values in (
        ("H", (0, 1, 2, 0x7FFF, 0x8000, 0xFFFF)),
        ("I", (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 44_101)),
        ("Q", (0, 2**31, 2**32, 2**63, 2**64 - 1)),
        ("f", (float("nan"), float("inf"), -1.0)),
        ("d", (float("nan"), float("-inf"), 1e308)),
    )
    for value in values
]
"""What lengths, counts, rates and samples are in files that are made to hurt."""
_TEXTS = (
    'nan inf -inf NaN infinity 1e999 -1e999 -1 0 1e-400 0x10 1_000 1,5 1.5.2 "" \' [ ] { } = # , ; \t \r \n \0 \u0661 '
    "\ufeff true null 99999999999999999999 [[[[[[[[[[[[[[ {a={a={a= a.b.c.d.e.f.g.h.i.j.k.l.m.n.o"
).split(" ")
"""What is put into text."""


def mutated(content: bytes, chance: random.Random, others: Sequence[bytes], change: "Change") -> bytes:
    """Change a file in one to four places.

    Parameters
    ----------
    content : bytes
    chance : Random
    others : sequence of bytes
        Files that a piece may come from.
    change : callable
        `of_bytes` or `of_text`.
    """
    whole = bytearray(content)
    for _ in range(chance.choice((1, 1, 1, 2, 3, 4))):
        change(whole, chance, others)
    return bytes(whole)


Change = Callable[[bytearray, random.Random, Sequence[bytes]], None]


def of_bytes(whole: bytearray, chance: random.Random, others: Sequence[bytes]) -> None:
    """Change a bit, a byte or a number, cut, repeat, move or take a piece from elsewhere; the header more often."""
    size = len(whole)
    place = chance.randrange(min(size, chance.choice((64, 512, size))) + 1) if size else 0
    match chance.randrange(8):
        case 0 if place < size:
            whole[place] ^= 1 << chance.randrange(8)
        case 1 if place < size:
            whole[place] = chance.randrange(256)
        case 2:
            word = chance.choice(_WORDS)
            whole[place : place + len(word)] = word
        case 3:
            del whole[place:]
        case 4:
            del whole[place : place + chance.randrange(1, 64)]
        case 5:
            whole[place:place] = whole[place : place + chance.randrange(1, 64)]
        case 6:
            other = chance.choice(others)
            start = chance.randrange(len(other))
            whole[place : place + 64] = other[start : start + 64]
        case _:
            whole[place:place] = chance.randbytes(chance.randrange(1, 32))


def of_text(whole: bytearray, chance: random.Random, others: Sequence[bytes]) -> None:
    """Change a character, or put in something that is no number, or a line from elsewhere."""
    size = len(whole)
    place = chance.randrange(min(size, chance.choice((100, size))) + 1) if size else 0
    match chance.randrange(6):
        case 0:
            text = chance.choice(_TEXTS).encode()
            whole[place : place + chance.randrange(0, 4)] = text
        case 1:
            lines = bytes(whole).split(b"\n")
            number = chance.randrange(len(lines))
            cells = lines[number].split(b",")
            cells[chance.randrange(len(cells))] = chance.choice(_TEXTS).encode()
            lines[number] = b",".join(cells)
            whole[:] = b"\n".join(lines)
        case 2:
            lines = chance.choice(others).split(b"\n")
            whole[place:place] = b"\n" + chance.choice(lines) + b"\n"
        case _:
            of_bytes(whole, chance, others)
