"""Outer loops as named arrays, to be uploaded to the stage's processor, and back."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from calibration.state_space.model import InnovationModel
from stagectl.stage.servo import Servo
from stagectl.stage.state_feedback import StateFeedback

_MODEL = ("A", "B", "C", "D", "K", "innovation")
_LOOP = ("gain", "feedback", "servo_feedback", "forward")
_SERVO = ("A", "B", "weight")


def loop_parameters(axes: Sequence[str], loops: Sequence[StateFeedback]) -> dict[str, np.ndarray]:
    """Return the numbers of the loops, `x.model.A` to `z.servo.weight`.

    Parameters
    ----------
    axes : sequence of str, such as x, y, z
    loops : sequence of StateFeedback, one an axis

    Returns
    -------
    dict of arrays, float64, any shape, the units of `StateFeedback`
    """
    found: dict[str, np.ndarray] = {}
    for axis, loop in zip(axes, loops, strict=True):
        found |= {f"{axis}.model.{name}": np.asarray(getattr(loop.model, name)) for name in _MODEL}
        found |= {f"{axis}.{name}": np.asarray(getattr(loop, name), float) for name in _LOOP}
        found |= {f"{axis}.servo.{name}": np.asarray(getattr(loop.servo, name), float) for name in _SERVO}
    return found


def loops_from(axes: Sequence[str], parameters: Mapping[str, np.ndarray], rate: float) -> list[StateFeedback]:
    """Return the loops, one an axis.

    Parameters
    ----------
    axes : sequence of str
    parameters : mapping of str to array, any shape, the units of `StateFeedback`
    rate : float, samples/s

    Raises
    ------
    ValueError : a number is missing, unknown, or of a shape that does not fit.
    """
    names = [*(f"model.{name}" for name in _MODEL), *_LOOP, *(f"servo.{name}" for name in _SERVO)]
    wanted = {f"{axis}.{name}" for axis in axes for name in names}
    if wanted != parameters.keys():
        odd = sorted(wanted ^ parameters.keys())[0]
        raise ValueError(f"parameter {odd} is {'missing' if odd in wanted else 'unknown'}")
    return [_loop({name: parameters[f"{axis}.{name}"] for name in names}, axis, rate) for axis in axes]


def loops_as_json(axes: Sequence[str], loops: Sequence[StateFeedback]) -> dict[str, Any]:
    """Return the numbers of the loops as a run's `run.json` holds them.

    Parameters
    ----------
    axes : sequence of str
    loops : sequence of StateFeedback, one an axis
    """
    return {name: each.tolist() for name, each in loop_parameters(axes, loops).items()}


def loops_from_json(axes: Sequence[str], told: Mapping[str, Any], rate: float) -> list[StateFeedback]:
    """Return the loops that a run's `run.json` holds; ValueError as of `loops_from`.

    Parameters
    ----------
    axes : sequence of str
    told : mapping of str to lists of numbers
        As of `loops_as_json`.
    rate : float, samples/s
    """
    return loops_from(axes, {name: np.array(each, float) for name, each in told.items()}, rate)


def _loop(numbers: Mapping[str, np.ndarray], axis: str, rate: float) -> StateFeedback:
    A, B, C, D, K, innovation = (numbers[f"model.{name}"] for name in _MODEL)
    model = InnovationModel(A, B, C, D, K, rate, innovation)
    servo = Servo(*(numbers[f"servo.{name}"] for name in _SERVO))
    n, s = model.order, len(servo.A)
    shapes = {
        "gain": (n, 1),
        "feedback": (1, n),
        "servo_feedback": (1, s),
        "forward": (),
        "servo.A": (s, s),
        "servo.B": (s, 1),
        "servo.weight": (s,),
    }
    for name, shape in shapes.items():
        if numbers[name].shape != shape:
            raise ValueError(f"parameter {axis}.{name} has shape {numbers[name].shape}, must be {shape}")
    gain, feedback, servo_feedback = (numbers[name] for name in _LOOP[:3])
    return StateFeedback(model, gain, feedback, servo, servo_feedback, float(numbers["forward"]))
