"""The axes' compiled kernel: LQ feedback from a Kalman filter with servo states, then a PID, a sample at a time."""

import math

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed
from rigkit.record import Record
from stagectl.stage.axis_record import CHANGE_MODEL, GO_ON, IDLE, START


@njit(cache=True, nogil=True)
def _limited(value: float, last: float, step: float, low: float, high: float) -> float:
    """Return `value` within low ... high and within a step of `last`."""
    low, high = max(low, last - step), min(high, last + step)
    return min(max(value, low), high)


@njit(cache=True, nogil=True)
def _advanced(axis: Record) -> float:
    """Move the reference's ramp by a sample and return the weight of the reference."""
    if axis.rising and axis.ramp_at < axis.ramp:
        axis.ramp_at += 1
    elif not axis.rising and axis.ramp_at > 0:
        axis.ramp_at -= 1
    if axis.ramp_at == axis.ramp:
        return 1.0
    return 0.5 - 0.5 * math.cos(math.pi * axis.ramp_at / axis.ramp)


@njit(cache=True, nogil=True)
def _followed(axis: Record, reference: float) -> float:
    """Return the reference to follow: within its limits, and ramped from and to `home`."""
    if math.isnan(reference):
        reference = axis.reference
        axis.reference_limited += 1
    elif not axis.reference_low <= reference <= axis.reference_high:
        reference = min(max(reference, axis.reference_low), axis.reference_high)
        axis.reference_limited += 1
    axis.reference = reference
    weight = _advanced(axis)
    if weight == 1.0:
        axis.home = axis.rest
        return reference
    return float(axis.home + weight * (reference - axis.home))


@njit(cache=True, nogil=True)
def _begin(axis: Record, position: float, extension: float) -> None:
    """Take where the axis stands for the zero of its model, so that the first output is what is there already."""
    for i in range(axis.states):
        axis.state[i] = 0.0
    for i in range(axis.servo_states):
        axis.servo_state[i] = 0.0
    axis.position_zero = position
    if axis.command == START:
        within = min(max(extension, axis.extension_low), axis.extension_high)
        axis.extension_zero = axis.extension_reference = within
        axis.home = axis.reference = position
        axis.ramp_at = 0
        axis.slope = 0.0
        axis.error = within - extension
    else:
        axis.extension_zero = axis.extension_reference


@njit(cache=True, nogil=True)
def _outer_sum(axis: Record, deviation: float) -> float:
    """Return (2.3): the extension asked for, before limits."""
    extension: float = axis.extension_zero + axis.forward * deviation
    for i in range(axis.states):
        extension -= axis.feedback[i] * axis.state[i]
    for i in range(axis.servo_states):
        extension -= axis.servo_feedback[i] * axis.servo_state[i]
    return extension


@njit(cache=True, nogil=True)
def _outer(axis: Record, followed: float, position: float) -> float:
    """Return the extension reference of this sample and take filter and servo states to the next, (2.3)-(2.5)."""
    deviation, error = followed - axis.position_zero, followed - position
    if axis.command != GO_ON:
        axis.servo_state[0] += (_outer_sum(axis, deviation) - axis.extension_reference) / axis.servo_feedback[0]
    asked = _outer_sum(axis, deviation)
    given = _limited(asked, axis.extension_reference, axis.extension_step, axis.extension_low, axis.extension_high)
    axis.extension_limited += given != asked
    drive, measured, excess = given - axis.extension_zero, position - axis.position_zero, given - asked
    states, servo_states = axis.states, axis.servo_states
    for i in range(states):
        total = axis.drive[i] * drive + axis.correction[i] * measured
        for j in range(states):
            total += axis.observer[i, j] * axis.state[j]
        axis.next_state[i] = flushed(total)
    for i in range(states):
        axis.state[i] = axis.next_state[i]
    for i in range(servo_states):
        total = axis.servo_error[i] * error + axis.servo_tracking[i] * excess
        for j in range(servo_states):
            total += axis.servo[i, j] * axis.servo_state[j]
        axis.next_servo_state[i] = flushed(total)
    for i in range(servo_states):
        axis.servo_state[i] = axis.next_servo_state[i]
    axis.extension_reference = given
    return given


@njit(cache=True, nogil=True)
def _inner(axis: Record, extension: float) -> float:
    """Return the voltage asked for, (2.2) and feedforward, with tracking anti-windup."""
    error = axis.extension_reference - extension
    slope = flushed(axis.derivative_pole * axis.slope + axis.derivative * (error - axis.error))
    now = axis.proportional * error + slope + axis.direct * axis.extension_reference
    if axis.command != GO_ON:
        axis.integral = axis.voltage - now
    asked = now + axis.integral
    given = _limited(asked, axis.voltage, axis.voltage_step, axis.voltage_low, axis.voltage_high)
    axis.voltage_limited += given != asked
    axis.integral = flushed(axis.integral + (axis.integration * error + axis.tracking * (given - asked)))
    axis.slope, axis.error, axis.voltage = slope, error, given
    return given


@njit(cache=True, nogil=True)
def run(
    reference: np.ndarray,
    position: np.ndarray,
    extension: np.ndarray,
    request: np.ndarray,
    extension_reference: np.ndarray,
    axes: np.ndarray,
) -> None:
    """Run one frame of every axis: shape (frames, axes) each, m and V."""
    for n in range(len(reference)):
        for number in range(axes.size):
            axis = axes[number]
            measured, stretched = position[n, number], extension[n, number]
            if axis.phase == IDLE:
                extension_reference[n, number], request[n, number] = stretched, axis.voltage
                continue
            if axis.command == START or axis.command == CHANGE_MODEL:
                _begin(axis, measured, stretched)
            followed = _followed(axis, reference[n, number])
            extension_reference[n, number] = _outer(axis, followed, measured)
            request[n, number] = _inner(axis, stretched)
            axis.command = GO_ON


@njit(cache=True, nogil=True)
def run_inner(extension_reference: np.ndarray, extension: np.ndarray, request: np.ndarray, axes: np.ndarray) -> None:
    """Run one frame of every axis' PID alone: shape (frames, axes) each, m and V."""
    for n in range(len(extension)):
        for number in range(axes.size):
            axis = axes[number]
            stretched = extension[n, number]
            if axis.phase == IDLE:
                request[n, number] = axis.voltage
                continue
            if axis.command == START:
                axis.home = axis.extension_reference = min(max(stretched, axis.extension_low), axis.extension_high)
                axis.ramp_at, axis.slope, axis.error = 0, 0.0, axis.home - stretched
            asked, last = extension_reference[n, number], axis.extension_reference
            if math.isnan(asked):
                asked = last
            asked = axis.home + _advanced(axis) * (asked - axis.home)
            axis.extension_reference = _limited(
                asked, last, axis.extension_step, axis.extension_low, axis.extension_high
            )
            axis.extension_limited += axis.extension_reference != asked
            request[n, number] = _inner(axis, stretched)
            axis.command = GO_ON
