"""The clamping procedure's compiled kernel: one step after the other, a sample at a time over a whole frame."""

import math

from numba import njit

MOVE, SOFTEN, CLAMP, CHECK, SEARCH, ALTERNATE, UNCLAMP, STIFFEN = range(8)
"""Kinds of steps, in the order of `clamp_procedure.KINDS`."""

STEP, PART, COUNT, SAMPLE, CAUSE, JOINT, PAUSED, STEPS, QUIET, ROUND, SOFT, CLAMPED, BEGUN = range(13)
"""Of `state`, whole numbers.  PART of a push: 0, 2.. up, 1, 3.. down; of a search: the joint that is looked at."""

NUMBER, PORT, TORQUE, TRAVEL, REACH, NO_ZERO, NO_ANSWER, OPENED, OUTSIDE = range(1, 10)
"""Of CAUSE: 0 is none."""

REFERENCE, NEUTRAL, CLAMPED_AT, FROM, SEARCH_STEP, SIGN, SUM = range(7)
"""Rows of `memory`, a joint a column: rad, rad, rad, rad, rad, 1, N m."""

SPEED, MOST, TURN, PROOF, QUIET_BELOW, TRAVELS, REACHES, FIRST_STEP = range(8)
"""Rows of `limits`, a joint a column; SPEED is rad a sample."""

APPROACH, SETTLE, PATIENCE, ROUNDS, PUSHES = range(5)
"""Of `times`: rad a sample, samples, samples, 1, 1."""


@njit(cache=True, nogil=True)
def abort(state, cause, joint):  # type: ignore[no-untyped-def]
    """Latch a cause, unless there is one."""
    if state[CAUSE] == 0:
        state[CAUSE], state[JOINT] = cause, joint


@njit(cache=True, nogil=True)
def _next(state):  # type: ignore[no-untyped-def]
    state[STEP] += 1
    state[PART], state[COUNT] = 0, 0


@njit(cache=True, nogil=True)
def _watch(angle, torque, clamped, fault, state, memory, limits):  # type: ignore[no-untyped-def]
    """Look at what must hold in every sample."""
    if not fault < 1.0:  # NaN as well
        abort(state, PORT, 0)
    for joint in range(len(angle)):
        if not (math.isfinite(angle[joint]) and math.isfinite(torque[joint])):
            abort(state, NUMBER, joint)
        elif not abs(torque[joint]) <= limits[MOST, joint]:
            abort(state, TORQUE, joint)
        elif state[CLAMPED] == 1 and not abs(angle[joint] - memory[CLAMPED_AT, joint]) <= limits[TRAVELS, joint]:
            abort(state, TRAVEL, joint)
    if state[CLAMPED] == 1 and not clamped >= 1.0:
        abort(state, OPENED, 0)


@njit(cache=True, nogil=True)
def _move(target, state, memory, times):  # type: ignore[no-untyped-def]
    """Go to a pose along a raised cosine, all joints together, and settle."""
    if state[COUNT] == 0:
        memory[FROM, :] = memory[REFERENCE, :]
    far = 0.0
    for joint in range(len(target)):
        far = max(far, abs(target[joint] - memory[FROM, joint]))
    samples = max(1.0, math.ceil(far * 0.5 * math.pi / times[APPROACH]))
    state[COUNT] += 1
    share = 0.5 - 0.5 * math.cos(math.pi * min(state[COUNT] / samples, 1.0))
    for joint in range(len(target)):
        memory[REFERENCE, joint] = memory[FROM, joint] + share * (target[joint] - memory[FROM, joint])
    if state[COUNT] >= samples + times[SETTLE]:
        _next(state)


@njit(cache=True, nogil=True)
def _signal(kind, angle, softened, clamped, state, memory, times):  # type: ignore[no-untyped-def]
    """Ask for soft servo or clamp and wait for the answer."""
    wanted = 1 if kind == SOFTEN or kind == CLAMP else 0
    of_servo = kind == SOFTEN or kind == STIFFEN
    if kind == UNCLAMP:
        state[CLAMPED] = 0  # may open from here on
    if of_servo:
        state[SOFT] = wanted
    state[COUNT] += 1
    answer = softened if of_servo else clamped
    if (answer >= 1.0) == (wanted == 1):
        if kind == CLAMP:
            state[CLAMPED] = 1
            memory[CLAMPED_AT, :] = angle
            memory[NEUTRAL, :] = memory[REFERENCE, :]
        _next(state)
    elif state[COUNT] > times[PATIENCE]:
        abort(state, NO_ANSWER, kind)


@njit(cache=True, nogil=True)
def _toward(joint, target, state, memory, limits):  # type: ignore[no-untyped-def]
    """Bring one reference nearer to a target by what its speed allows; return whether it is there."""
    step = limits[SPEED, joint]
    left = target - memory[REFERENCE, joint]
    memory[REFERENCE, joint] = target if abs(left) <= step else memory[REFERENCE, joint] + math.copysign(step, left)
    if not abs(memory[REFERENCE, joint] - memory[NEUTRAL, joint]) <= limits[REACHES, joint]:
        abort(state, REACH, joint)
    return abs(left) <= step


@njit(cache=True, nogil=True)
def _push(joint, torque, turn, pushes, state, memory, limits):  # type: ignore[no-untyped-def]
    """Push one joint up and down until its torque turns it round, then bring it back to where it began."""
    if state[PART] == pushes:
        if _toward(joint, memory[NEUTRAL, joint], state, memory, limits):
            _next(state)
        return
    sign = 1.0 if state[PART] % 2 == 0 else -1.0
    _toward(joint, memory[REFERENCE, joint] + sign * limits[SPEED, joint], state, memory, limits)
    if sign * torque[joint] >= turn:
        state[PART] += 1


@njit(cache=True, nogil=True)
def _search(torque, state, memory, limits, times):  # type: ignore[no-untyped-def]
    """Look at one joint's mean torque after the other and step its reference against it, until all are quiet."""
    joints, joint = len(torque), state[PART]
    if state[COUNT] == 0 and state[ROUND] == 0 and joint == 0:
        memory[SEARCH_STEP, :] = limits[FIRST_STEP, :]
        memory[SIGN, :], memory[FROM, :] = 0.0, memory[REFERENCE, :]
        state[QUIET] = 0
    if not _toward(joint, memory[FROM, joint], state, memory, limits):
        return
    state[COUNT] += 1
    if state[COUNT] == 1:
        memory[SUM, joint] = 0.0
    if state[COUNT] > times[SETTLE]:
        memory[SUM, joint] += torque[joint]
    if state[COUNT] < 2 * times[SETTLE]:
        return
    mean = memory[SUM, joint] / times[SETTLE]
    if abs(mean) <= limits[QUIET_BELOW, joint]:
        state[QUIET] += 1
    else:
        sign = math.copysign(1.0, mean)
        if sign * memory[SIGN, joint] < 0:
            memory[SEARCH_STEP, joint] *= 0.5
        memory[SIGN, joint] = sign
        memory[FROM, joint] = memory[REFERENCE, joint] - sign * memory[SEARCH_STEP, joint]
        state[QUIET] = 0
    state[COUNT], state[PART] = 0, (joint + 1) % joints
    if state[QUIET] == 2 * joints:  # a step is made at the next look: all again after the last of them
        memory[NEUTRAL, :] = memory[REFERENCE, :]
        _next(state)
    elif state[PART] == 0:
        state[ROUND] += 1
        if state[ROUND] >= times[ROUNDS]:
            abort(state, NO_ZERO, joint)


@njit(cache=True, nogil=True)
def _retreat(state, memory, limits):  # type: ignore[no-untyped-def]
    """After a torque too large, go back to where there was little; after anything else, stay."""
    if state[CAUSE] == TORQUE and state[CLAMPED] == 1:
        for joint in range(memory.shape[1]):
            left = memory[NEUTRAL, joint] - memory[REFERENCE, joint]
            step = min(abs(left), limits[SPEED, joint])
            memory[REFERENCE, joint] += math.copysign(step, left)


@njit(cache=True, nogil=True)
def run(seen, asked, settings, memory, state):  # type: ignore[no-untyped-def]
    """Run one frame: ports in and out, (frames, joints) or (frames, 1); `program` is kind and joint of each step."""
    angle, torque, softened, clamped, fault = seen
    reference, soft, clamp, joint = asked
    program, targets, limits, times = settings
    for n in range(len(angle)):
        if state[BEGUN] == 0:
            memory[REFERENCE, :] = angle[n]
            state[BEGUN] = 1
        actuated = 0.0
        if state[CAUSE] == 0:
            _watch(angle[n], torque[n], clamped[n, 0], fault[n, 0], state, memory, limits)
        if state[CAUSE] != 0:
            _retreat(state, memory, limits)
        elif state[STEP] < state[STEPS] and state[PAUSED] == 0:
            kind, which = program[state[STEP], 0], program[state[STEP], 1]
            if kind == MOVE:
                _move(targets[state[STEP]], state, memory, times)
            elif kind == SEARCH:
                _search(torque[n], state, memory, limits, times)
            elif kind == CHECK:
                _push(which, torque[n], limits[PROOF, which], 2, state, memory, limits)
            elif kind == ALTERNATE:
                actuated = which + 1.0 if state[PART] < times[PUSHES] else 0.0
                _push(which, torque[n], limits[TURN, which], times[PUSHES], state, memory, limits)
            else:
                _signal(kind, angle[n], softened[n, 0], clamped[n, 0], state, memory, times)
        closing = state[STEP] < state[STEPS] and program[state[STEP], 0] == CLAMP and state[CAUSE] == 0
        reference[n] = memory[REFERENCE]
        soft[n, 0] = state[SOFT]
        clamp[n, 0] = 1.0 if state[CLAMPED] == 1 or closing else 0.0
        joint[n, 0] = actuated
        state[SAMPLE] += 1
