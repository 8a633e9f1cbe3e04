"""What a plant can be told: each option declared once, with default, unit and range, and refused by name outside it."""

from dataclasses import Field, field, fields
from math import inf
from typing import Any


def option(default: float, unit: str, low: float, high: float = inf) -> Any:
    """Declare a number as a field of a dataclass; a whole default wants whole numbers.

    Parameters
    ----------
    default : float or int, in the unit
    unit : str
        "1" for a pure number, empty for a count.
    low, high : float, in the unit
        Smallest and largest value allowed.

    Returns
    -------
    dataclass field
    """
    return field(default=default, metadata={"unit": unit, "range": (low, high)})


def choice(*allowed: str) -> Any:
    """Declare a word as a field of a dataclass; the first allowed one is the default.

    Returns
    -------
    dataclass field
    """
    return field(default=allowed[0], metadata={"allowed": allowed})


def chosen(holder: object, options: type[Any]) -> dict[str, Any]:
    """Return the options of a dataclass as its holder has them, by name: keywords to build a plant with."""
    return {each.name: getattr(holder, each.name) for each in fields(options)}


def refuse_wrong_options(options: Any) -> None:
    """Check every field that `option` or `choice` declared.

    Parameters
    ----------
    options : dataclass instance

    Raises
    ------
    ValueError : an option outside its range or of another type, by name.
    """
    for each in fields(options):
        value = getattr(options, each.name)
        allowed = _missed(each, value)
        if allowed:
            raise ValueError(f"simulator.options.{each.name} is {value!r}, must be {allowed}")


def _missed(declared: Field[Any], value: object) -> str:
    """Return what is allowed where `value` is not, else nothing."""
    if "allowed" in declared.metadata:
        words = declared.metadata["allowed"]
        return "" if value in words else " or ".join(map(repr, words))
    if "range" not in declared.metadata:
        return ""
    low, high = declared.metadata["range"]
    whole, unit = isinstance(declared.default, int), declared.metadata["unit"]
    right = isinstance(value, int if whole else int | float) and not isinstance(value, bool)
    if right and low <= value <= high:
        return ""
    within = f">= {low:g}" if high == inf else f"{low:g} to {high:g}"
    return f"a whole number {within}" if whole else f"{within} {unit}".removesuffix(" 1")


def refuse_rate(rate: float, low: float, high: float, of: str) -> None:
    """Refuse a rate, samples/s, at which a plant is not simulated; `of` says which plant.

    Raises
    ------
    ValueError
    """
    if not low <= rate <= high:
        raise ValueError(f"rate is {rate!r} samples/s, must be {low:g} to {high:g} for {of}")
