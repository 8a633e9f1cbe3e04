"""Channels in sentences by the names that a person gave them."""

import re
from collections.abc import Iterable, Sequence

_CHANNEL = re.compile(r"\b(input|output)s? (\d+)(?: and (\d+))?\b")


def by_name(sentences: Iterable[str], inputs: Sequence[str], outputs: Sequence[str]) -> tuple[str, ...]:
    """Return sentences on "input 1" or "outputs 1 and 2" with the channels' names, where they have some.

    Parameters
    ----------
    sentences : iterable of str
    inputs, outputs : sequences of str
        Names; empty where nobody gave any.

    Examples
    --------
    >>> by_name(["no output hears of input 2", "inputs 1 and 2 are the same signal"], ["force", "torque"], [])
    ('no output hears of torque', 'force and torque are the same signal')
    """

    def named(found: re.Match[str]) -> str:
        names = inputs if found[1] == "input" else outputs
        numbers = [int(each) for each in found.groups()[1:] if each is not None]
        if not all(1 <= number <= len(names) for number in numbers):
            return found[0]
        return " and ".join(names[number - 1] for number in numbers)

    return tuple(_CHANNEL.sub(named, sentence) for sentence in sentences)
