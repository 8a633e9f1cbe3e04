"""Uploads a parameter set to the stage: in chunks, read back and compared, then put into use as a whole."""

from collections.abc import Mapping

import numpy as np

from stagectl.link.bus import LinkError
from stagectl.link.stage_link import StageLink
from stagectl.wire.messages import LONG_DATA, SHORT_DATA, WINDOW, Command, Result
from stagectl.wire.parameters import checksum, chunks, pack_parameters

_ATTEMPTS = 20
"""Times without progress after which it is given up."""


def upload(link: StageLink, parameters: Mapping[str, np.ndarray]) -> int:
    """Have the stage use other parameters from its next block on; return the set's CRC-32, as in its status.

    Until the whole set has come back bit for bit, and the stage's loops have taken it, nothing changes.

    Parameters
    ----------
    link : StageLink, open
    parameters : mapping of str to array, any shape, any unit, float32 or float64

    Raises
    ------
    WireError : they cannot be sent, or are too many.
    LinkError : the stage does not answer, or refuses them.
    """
    image = pack_parameters(parameters)
    pieces = list(enumerate(chunks(image, LONG_DATA if link.link.form == "fd" else SHORT_DATA)))
    _demand(link, Command.BEGIN, len(image))
    _write(link, pieces)
    _compare(link, pieces)
    _demand(link, Command.COMMIT, checksum(image))
    return checksum(image)


def _write(link: StageLink, pieces: list[tuple[int, bytes]]) -> None:
    there = idle = 0
    while there < len(pieces):
        link.write(pieces[there : there + WINDOW])
        before, there = there, _demand(link, Command.CHECK, 0)
        idle = idle + 1 if there == before else 0
        if idle > _ATTEMPTS:
            raise LinkError(f"chunk {there} of {len(pieces)} of the parameters does not arrive")


def _compare(link: StageLink, pieces: list[tuple[int, bytes]]) -> None:
    back: dict[int, bytes] = {}
    idle = 0
    while len(back) < len(pieces):
        first = next(number for number, _ in pieces if number not in back)
        _demand(link, Command.READ, first)
        came = link.read(range(first, min(first + WINDOW, len(pieces))))
        idle = 0 if came else idle + 1
        back |= came
        if idle > _ATTEMPTS:
            raise LinkError(f"chunk {first} of {len(pieces)} of the parameters does not come back")
    differing = [number for number, data in pieces if back[number] != data]
    if differing:
        raise LinkError(f"chunk {differing[0]} of {len(pieces)} of the parameters came back changed")


def _demand(link: StageLink, command: Command, argument: int) -> int:
    result, about = link.ask(command, argument)
    if result is not Result.DONE:
        raise LinkError(f"the stage refuses the parameters at {command.name}: {result.name}")
    return about
