"""Adaptive internal model control of one axis in plain numpy, a sample a call, written apart from the compiled one."""

import numpy as np

from stagectl.robot.midranging.internal_model import NOISES, InternalModelAxis
from stagectl.robot.midranging.internal_model_kernel import SMOOTH
from stagectl.robot.midranging.least_squares import ALARM, DRIFT, LeastSquares


class Squares:
    """Recursive least squares of one loop, with smoothing, gate, alarm and bound."""

    def __init__(self, settings: LeastSquares, guess: np.ndarray, rate: float) -> None:
        self.settings, self.estimate, self.order = settings, guess.copy(), len(guess) // 2
        self.pole = np.exp(-1.0 / (settings.smoothing * rate)) if settings.smoothing else 0.0
        self.variance = ((1.0 - self.pole) * settings.noise) ** 2
        self.start = settings.deviation**2 / self.variance
        self.covariance = self.start * np.eye(2 * self.order)
        self.regressors, self.slow, self.alarm = np.zeros(2 * self.order), 0.0, 0.0

    def observe(self, output: float) -> None:
        """Take an output in."""
        order, past = self.order, self.regressors
        smooth = self.pole * past[0] + (1.0 - self.pole) * output
        if abs(past[order] - self.slow) >= self.settings.gate * self.settings.noise:
            residual, direction = smooth - past @ self.estimate, self.covariance @ past
            surprise = residual**2 / (self.variance * (1.0 + past @ direction))
            self.alarm = max(0.0, self.alarm + min(surprise, ALARM) - DRIFT)
            if self.settings.alarm and self.alarm > ALARM:
                self.covariance, self.alarm = self.start * np.eye(2 * order), 0.0
                direction = self.covariance @ past
            gain = direction / (self.settings.forgetting + past @ direction)
            self.estimate += gain * residual
            self.covariance = (self.covariance - np.outer(gain, direction)) / self.settings.forgetting
            self.covariance *= min(1.0, 2 * order * self.start / np.trace(self.covariance))
        past[1:order] = past[: order - 1].copy()
        past[0] = smooth

    def apply(self, value: float) -> None:
        """Take in what the loop is given."""
        order, past = self.order, self.regressors
        smooth = self.pole * past[order] + (1.0 - self.pole) * value
        past[order + 1 :] = past[order:-1].copy()
        past[order] = smooth
        self.slow += (1.0 - self.pole) * (smooth - self.slow)


class Loop:
    """The internal model of one loop and its inverse."""

    def __init__(self, guess: np.ndarray) -> None:
        order = len(guess) // 2
        self.order, self.outputs, self.inputs = order, np.zeros(order), np.zeros(order)
        self.inverse_outputs, self.inverse_inputs = np.zeros(order), np.zeros(order)
        self.adopt(guess)

    def adopt(self, estimate: np.ndarray) -> None:
        """Use an estimate whose poles are inside; mirror its zeros."""
        a, b = estimate[: self.order], estimate[self.order :]
        rest = 1.0 - a.sum()
        if (
            max(abs(np.roots(np.concatenate(([1.0], -a)))), default=0.0) >= 0.9995
            or not 0.5 * rest <= b.sum() <= 2.0 * rest
        ):
            return
        self.a, self.b = a.copy(), b.copy()
        zeros = np.roots(b)
        outside = abs(zeros) > 1.0
        mirrored = np.where(outside, 1.0 / np.where(outside, zeros, 1.0).conj(), zeros)
        gain = b[0] * np.prod(np.where(outside, -zeros, 1.0))
        self.mirrored = np.atleast_1d(np.real(gain * np.poly(mirrored)))

    def output(self) -> float:
        """Return the model's output."""
        return float(self.a @ self.outputs + self.b @ self.inputs)

    def invert(self, wanted: float) -> float:
        """Return what makes the output `wanted` a sample later."""
        value = wanted - self.a @ self.inverse_inputs - self.mirrored[1:] @ self.inverse_outputs[: self.order - 1]
        value /= self.mirrored[0]
        self.inverse_inputs = np.concatenate(([wanted], self.inverse_inputs[:-1]))
        self.inverse_outputs = np.concatenate(([value], self.inverse_outputs[:-1]))
        return float(value)

    def ahead(self, output: float, value: float) -> float:
        """Return the model's output a sample later, from the one now and what it is given now."""
        return float(self.a @ [output, *self.outputs[:-1]] + self.b @ [value, *self.inputs[:-1]])

    def push(self, output: float, value: float) -> None:
        """Go on by a sample."""
        self.outputs = np.concatenate(([output], self.outputs[:-1]))
        self.inputs = np.concatenate(([value], self.inputs[:-1]))


class NumpyAxis:
    """One axis, its estimation phase left out, without dead times and the limit of the travel."""

    def __init__(self, axis: InternalModelAxis, rate: float) -> None:
        order = axis.order
        guesses = [each.of_order(order).parameters for each in (axis.fast, axis.slow)]
        learning = axis.fast_learning, axis.slow_learning
        self.squares = [Squares(each, guess, rate) for each, guess in zip(learning, guesses, strict=True)]
        self.loops = [Loop(guess) for guess in guesses]
        self.wanted = [Loop(each.of_order(order).parameters) for each in (axis.desired_fast, axis.desired_slow)]
        self.numerator, self.denominator = np.zeros(4), np.zeros(4)
        self.numerator[: len(axis.governor.numerator)] = axis.governor.numerator
        self.denominator[: len(axis.governor.denominator)] = axis.governor.denominator
        self.limit, self.middle = axis.governor.limit, axis.middle
        self.noise, self.offset = axis.fast_learning.noise, 0.0
        self.errors, self.controls = np.zeros(3), np.zeros(3)

    def step(self, reference: float, relative: float, fast: float, slow: float) -> tuple[float, float]:
        """Return the references of both loops."""
        position = fast - self.middle
        fast_modelled, slow_modelled = (loop.output() for loop in self.loops)
        error = reference - (relative - fast_modelled - slow_modelled)
        self.offset += SMOOTH * (position - fast_modelled - self.offset)
        for squares, loop, output in zip(self.squares, self.loops, (position, slow), strict=True):
            squares.observe(output)
            loop.adopt(squares.estimate)
        modelled = [loop.output() for loop in self.loops]
        desired = []
        for each in self.wanted:
            each.inputs = np.concatenate(([error], each.inputs[:-1]))
            desired.append(each.output())
            each.outputs = np.concatenate(([desired[-1]], each.outputs[:-1]))
        slow_given = self.loops[1].invert(desired[1])
        wanted = self.loops[0].invert(desired[0] - self.loops[1].ahead(modelled[1], slow_given))
        lean = NOISES[1] * self.noise
        governed = self._govern(wanted, float(np.clip(modelled[0] + self.offset, position - lean, position + lean)))
        given = governed, slow_given
        for squares, loop, output, value in zip(self.squares, self.loops, modelled, given, strict=True):
            loop.push(output, value)
            squares.apply(value)
        return governed + self.middle, slow_given

    def _govern(self, wanted: float, position: float) -> float:
        past = self.numerator[1:] @ self.errors - self.denominator[1:] @ self.controls
        reach = self.limit * self.denominator[0] - NOISES[0] * self.noise * self.numerator[0]
        low, high = position + (np.array([-reach, reach]) - past) / self.numerator[0]
        given = float(np.clip(wanted, low, high))
        control = (self.numerator[0] * (given - position) + past) / self.denominator[0]
        self.errors = np.concatenate(([given - position], self.errors[:-1]))
        self.controls = np.concatenate(([control], self.controls[:-1]))
        return given
