"""The clamping procedure's compiled kernel: one step after the other, a sample at a time over a whole frame."""

import math

import numpy as np

from rigkit.compiled import njit
from rigkit.record import Record

MOVE, SOFTEN, CLAMP, CHECK, SEARCH, ALTERNATE, UNCLAMP, STIFFEN = range(8)
"""Kinds of steps, in the order of `clamp_procedure.KINDS`."""

NUMBER, PORT, TORQUE, TRAVEL, REACH, NO_ZERO, NO_ANSWER, OPENED, OUTSIDE = range(1, 10)
"""Of `cause`: 0 is none."""

STATE = np.dtype(
    [
        ("step", "i8"),
        ("part", "i8"),  # of a push: 0, 2, .. up, 1, 3, .. down; of a search: the joint that is looked at
        ("count", "i8"),  # samples in the part
        ("sample", "i8"),  # since prepare
        ("cause", "i8"),
        ("joint", "i8"),  # at fault
        ("paused", "?"),
        ("steps", "i8"),
        ("quiet", "i8"),  # joints in a row
        ("rounds_done", "i8"),
        ("soft", "?"),
        ("clamped", "?"),
        ("begun", "?"),
        ("approach", "f8"),  # rad a sample
        ("settle", "f8"),  # samples
        ("patience", "f8"),  # samples
        ("rounds", "i8"),
        ("pushes", "i8"),
    ],
    align=True,
)
JOINT = np.dtype(
    [
        # rad
        ("reference", "f8"),
        ("neutral", "f8"),
        ("clamped_at", "f8"),
        ("begin", "f8"),
        ("search_step", "f8"),
        ("sign", "f8"),  # of the last mean torque
        ("sum", "f8"),  # N m, of torques
        # limits
        ("speed", "f8"),  # rad a sample
        ("most", "f8"),  # N m
        ("turn", "f8"),  # N m
        ("proof", "f8"),  # N m
        ("quiet_below", "f8"),  # N m
        ("travels", "f8"),  # rad
        ("reaches", "f8"),  # rad
        ("first_step", "f8"),  # rad
    ],
    align=True,
)

Frames = tuple[np.ndarray, ...]
"""One of each port."""


@njit(cache=True, nogil=True)
def abort(state: Record, cause: int, joint: int) -> None:
    """Latch a cause, unless there is one."""
    if state.cause == 0:
        state.cause, state.joint = cause, joint


@njit(cache=True, nogil=True)
def _next(state: Record) -> None:
    state.step += 1
    state.part, state.count = 0, 0


@njit(cache=True, nogil=True)
def _watch(
    angle: np.ndarray, torque: np.ndarray, clamped: float, fault: float, state: Record, joints: np.ndarray
) -> None:
    """Look at what must hold in every sample."""
    if not fault < 1.0:  # NaN as well
        abort(state, PORT, 0)
    for joint in range(len(angle)):
        if not (math.isfinite(angle[joint]) and math.isfinite(torque[joint])):
            abort(state, NUMBER, joint)
        elif not abs(torque[joint]) <= joints[joint].most:
            abort(state, TORQUE, joint)
        elif state.clamped and not abs(angle[joint] - joints[joint].clamped_at) <= joints[joint].travels:
            abort(state, TRAVEL, joint)
    if state.clamped and not clamped >= 1.0:
        abort(state, OPENED, 0)


@njit(cache=True, nogil=True)
def _move(target: np.ndarray, state: Record, joints: np.ndarray) -> None:
    """Go to a pose along a raised cosine, all joints together, and settle."""
    if state.count == 0:
        for joint in range(len(target)):
            joints[joint].begin = joints[joint].reference
    far = 0.0
    for joint in range(len(target)):
        far = max(far, abs(target[joint] - joints[joint].begin))
    samples = max(1.0, math.ceil(far * 0.5 * math.pi / state.approach))
    state.count += 1
    share = 0.5 - 0.5 * math.cos(math.pi * min(state.count / samples, 1.0))
    for joint in range(len(target)):
        joints[joint].reference = joints[joint].begin + share * (target[joint] - joints[joint].begin)
    if state.count >= samples + state.settle:
        _next(state)


@njit(cache=True, nogil=True)
def _signal(kind: int, angle: np.ndarray, softened: float, clamped: float, state: Record, joints: np.ndarray) -> None:
    """Ask for soft servo or clamp and wait for the answer."""
    wanted = kind == SOFTEN or kind == CLAMP
    of_servo = kind == SOFTEN or kind == STIFFEN
    if kind == UNCLAMP:
        state.clamped = False  # may open from here on
    if of_servo:
        state.soft = wanted
    state.count += 1
    answer = softened if of_servo else clamped
    if (answer >= 1.0) == wanted:
        if kind == CLAMP:
            state.clamped = True
            for joint in range(len(angle)):
                joints[joint].clamped_at = angle[joint]
                joints[joint].neutral = joints[joint].reference
        _next(state)
    elif state.count > state.patience:
        abort(state, NO_ANSWER, kind)


@njit(cache=True, nogil=True)
def _toward(number: int, target: float, state: Record, joints: np.ndarray) -> bool:
    """Bring one reference nearer to a target by what its speed allows; return whether it is there."""
    joint = joints[number]
    left = target - joint.reference
    is_there = abs(left) <= joint.speed
    joint.reference = target if is_there else joint.reference + math.copysign(joint.speed, left)
    if not abs(joint.reference - joint.neutral) <= joint.reaches:
        abort(state, REACH, number)
    return bool(is_there)


@njit(cache=True, nogil=True)
def _push(joint: int, torque: np.ndarray, turn: float, pushes: int, state: Record, joints: np.ndarray) -> None:
    """Push one joint up and down until its torque turns it round, then bring it back to where it began."""
    if state.part == pushes:
        if _toward(joint, joints[joint].neutral, state, joints):
            _next(state)
        return
    sign = 1.0 if state.part % 2 == 0 else -1.0
    _toward(joint, joints[joint].reference + sign * joints[joint].speed, state, joints)
    if sign * torque[joint] >= turn:
        state.part += 1


@njit(cache=True, nogil=True)
def _search(torque: np.ndarray, state: Record, joints: np.ndarray) -> None:
    """Look at one joint's mean torque after the other and step its reference against it, until all are quiet."""
    joint, count = state.part, state.count
    if count == 0 and state.rounds_done == 0 and joint == 0:
        for each in range(len(torque)):
            joints[each].search_step = joints[each].first_step
            joints[each].sign, joints[each].begin = 0.0, joints[each].reference
        state.quiet = 0
    if not _toward(joint, joints[joint].begin, state, joints):
        return
    count += 1
    state.count = count
    if count == 1:
        joints[joint].sum = 0.0
    if count > state.settle:
        joints[joint].sum += torque[joint]
    if count < 2 * state.settle:
        return
    mean = joints[joint].sum / state.settle
    if abs(mean) <= joints[joint].quiet_below:
        state.quiet += 1
    else:
        sign = math.copysign(1.0, mean)
        if sign * joints[joint].sign < 0:
            joints[joint].search_step *= 0.5
        joints[joint].sign = sign
        joints[joint].begin = joints[joint].reference - sign * joints[joint].search_step
        state.quiet = 0
    state.count, state.part = 0, (joint + 1) % len(torque)
    if state.quiet == 2 * len(torque):  # a step is made at the next look: all again after the last of them
        for each in range(len(torque)):
            joints[each].neutral = joints[each].reference
        _next(state)
    elif state.part == 0:
        state.rounds_done += 1
        if state.rounds_done >= state.rounds:
            abort(state, NO_ZERO, joint)


@njit(cache=True, nogil=True)
def _retreat(state: Record, joints: np.ndarray) -> None:
    """After a torque too large, go back to where there was little; after anything else, stay."""
    if state.cause == TORQUE and state.clamped:
        for joint in range(joints.size):
            left = joints[joint].neutral - joints[joint].reference
            step = min(abs(left), joints[joint].speed)
            joints[joint].reference += math.copysign(step, left)


@njit(cache=True, nogil=True)
def run(
    seen: Frames, asked: Frames, program: np.ndarray, targets: np.ndarray, joints: np.ndarray, states: np.ndarray
) -> None:
    """Run one frame: ports in and out, (frames, joints) or (frames, 1); `program` is kind and joint of each step."""
    angle, torque, softened, clamped, fault = seen
    reference, soft, clamp, joint = asked
    state = states[0]
    for n in range(len(angle)):
        if not state.begun:
            for number in range(joints.size):
                joints[number].reference = angle[n, number]
            state.begun = True
        actuated = 0.0
        if state.cause == 0:
            _watch(angle[n], torque[n], clamped[n, 0], fault[n, 0], state, joints)
        if state.cause != 0:
            _retreat(state, joints)
        elif state.step < state.steps and not state.paused:
            kind, which = program[state.step, 0], program[state.step, 1]
            if kind == MOVE:
                _move(targets[state.step], state, joints)
            elif kind == SEARCH:
                _search(torque[n], state, joints)
            elif kind == CHECK:
                _push(which, torque[n], joints[which].proof, 2, state, joints)
            elif kind == ALTERNATE:
                actuated = which + 1.0 if state.part < state.pushes else 0.0
                _push(which, torque[n], joints[which].turn, state.pushes, state, joints)
            else:
                _signal(kind, angle[n], softened[n, 0], clamped[n, 0], state, joints)
        closing = state.step < state.steps and program[state.step, 0] == CLAMP and state.cause == 0
        for number in range(joints.size):
            reference[n, number] = joints[number].reference
        soft[n, 0] = 1.0 if state.soft else 0.0
        clamp[n, 0] = 1.0 if state.clamped or closing else 0.0
        joint[n, 0] = actuated
        state.sample += 1
