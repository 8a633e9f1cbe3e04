"""Warnings that name the line of whoever called, however deep in this package they come up."""

import inspect
import warnings


def warn(text: str) -> None:
    """Warn of something about the records, at the first line on the way up that is not of `calibration`."""
    frame, level = inspect.currentframe(), 1
    while frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] == "calibration":
        frame, level = frame.f_back, level + 1
    warnings.warn(text, stacklevel=level)
