"""Blocks that a file names, as module:Class, with the keywords that it gives them."""

from collections.abc import Mapping

from ctlblocks import Block
from rigkit.config import resolve


def named_block(name: str, options: Mapping[str, object]) -> Block:
    """Build a Block.

    Parameters
    ----------
    name : str
        "module:Class".
    options : mapping of str to object
        Its keywords.

    Raises
    ------
    ValueError : there is none of that name, it does not take these options, or it is no Block.
    """
    try:
        made = resolve(name)(**options)
    except TypeError as fault:
        raise ValueError(f"{name} does not take these options: {fault}") from None
    if not isinstance(made, Block):
        raise ValueError(f"{name} makes a {type(made).__name__}, must be a Block")
    return made
