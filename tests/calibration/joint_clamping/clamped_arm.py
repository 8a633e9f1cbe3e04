"""An arm of six compliant joints in a clamp: a small plant for tests, written apart from the program.

Each joint: a servo with soft gain, a motor with inertia, LuGre friction that grows with the load, a gear with backlash
and a spring of two slopes.  The arm's side is held by the clamp's compliance and by the tilting of every joint's
bearing; it follows by a first-order law, fast beside the motions.  Not modelled: link inertia, gravity that changes
with the pose, thermal expansion, ripple of the gears.
"""

from dataclasses import dataclass, field

import numpy as np

from rigkit.compiled import njit

RATE = 250.0
INSIDE = 16
"""Steps a sample."""


@dataclass
class Joints:
    """What six joints are made of, an entry a joint, SI, on the joint's side of the gear."""

    k_plus: np.ndarray
    k_minus: np.ndarray
    backlash: np.ndarray
    hardening: np.ndarray
    torque: np.ndarray
    friction: np.ndarray
    friction_load: np.ndarray


@dataclass
class ClampedArm:
    """Six joints, the 6 x 6 compliance that they feel from arm side to ground, and the servo's gain."""

    joints: Joints
    arm_compliance: np.ndarray = field(default_factory=lambda: np.zeros((6, 6)))
    rest: np.ndarray = field(default_factory=lambda: np.zeros(6))
    noise: float = 0.002
    drift: float = 0.01
    outliers: float = 0.0
    seed: int = 1

    def __post_init__(self) -> None:
        self.state = np.zeros((4, 6))  # motor angle, its speed, bristle, arm-side angle
        self.state[0] = self.state[3] = self.rest

    def run(self, reference: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return measured angle and torque, and the true angle of the arm's side, for references a sample a row."""
        parts = self.joints
        stiffness = np.maximum(parts.k_plus, parts.k_minus)
        table = np.stack(
            [
                parts.k_plus,
                parts.k_minus,
                parts.backlash,
                parts.hardening,
                parts.friction,
                parts.friction_load,
                0.3 * stiffness,
                stiffness / 250.0**2,
            ]
        )
        lag = np.diag(0.004 * stiffness) * RATE * INSIDE
        follow = np.linalg.solve(self.arm_compliance @ lag + np.eye(6), self.arm_compliance)
        angle, torque, arm = _run(reference, self.state, table, follow, np.diag(lag).copy(), self.rest)
        random = np.random.default_rng(self.seed)
        time = np.linspace(0.0, 1.0, len(torque))[:, None]
        torque += parts.torque * self.noise * random.standard_normal(torque.shape)
        torque += parts.torque * self.drift * (np.exp(-3 * time) - 0.5)
        wrong = random.random(torque.shape) < self.outliers
        torque[wrong] += (parts.torque * random.standard_normal(torque.shape))[wrong]
        angle += 1e-6 * random.standard_normal(angle.shape)
        return angle, torque, arm


def random_joints(seed: int, *, backlash: bool = True, hardening: float = 0.0) -> Joints:
    """Draw six joints of a robot for 6 kg: windings of about 1 mrad at full torque."""
    random = np.random.default_rng(seed)
    torque = np.array([150.0, 150.0, 100.0, 25.0, 25.0, 15.0]) * random.uniform(0.8, 1.2, 6)
    k_plus = torque / random.uniform(0.7e-3, 1.5e-3, 6)
    return Joints(
        k_plus,
        k_plus * random.uniform(0.75, 1.3, 6),
        random.uniform(0.05e-3, 0.6e-3, 6) * backlash,
        np.full(6, hardening),
        torque,
        torque * random.uniform(0.04, 0.12, 6),
        random.uniform(0.0, 0.06, 6),
    )


def to_and_fro(arm: ClampedArm, joint: int, cycles: int = 5, seconds: float = 10.0) -> np.ndarray:
    """Return references that move one joint so far that its motor reaches about full torque."""
    parts = arm.joints
    soft = 0.3 * max(parts.k_plus[joint], parts.k_minus[joint])
    far = parts.torque[joint] * (1 / soft + 1 / parts.k_plus[joint]) + parts.backlash[joint]
    time = np.arange(0, cycles * seconds, 1 / RATE) / seconds
    wave = 2 * np.abs(2 * ((time + 0.25) % 1.0) - 1) - 1
    reference = np.tile(arm.rest, (len(time), 1))
    reference[:, joint] -= far * wave
    return reference


@njit(cache=True)
def _run(reference, state, table, follow, lag, rest):
    samples, joints = reference.shape
    angle, torque, arm = np.empty((samples, joints)), np.empty((samples, joints)), np.empty((samples, joints))
    step = 1 / (RATE * INSIDE)
    through, held = np.empty(joints), np.empty(joints)
    for n in range(samples):
        for _ in range(INSIDE):
            for i in range(joints):
                high, low, gap, hard, slip, load, soft, inertia = table[:, i]
                twist = state[0, i] - state[3, i]
                up, down = max(twist - gap / 2, 0.0), min(twist + gap / 2, 0.0)
                through[i] = high * up * (1 + hard * (up * 1e3) ** 2) + low * down * (1 + hard * (down * 1e3) ** 2)
                most = slip + load * abs(through[i])
                stiff = most / 2e-5
                rub = stiff * state[2, i]
                push = soft * (reference[n, i] - state[0, i]) - 2.0 * inertia * 250.0 * state[1, i]
                torque[n, i] = push
                state[1, i] = (state[1, i] + step / inertia * (push - rub - through[i])) / (1 + 50.0 * step)
                move = step * state[1, i]
                state[0, i] += move
                state[2, i] += move - abs(move) * stiff / most * state[2, i]
                held[i] = through[i] + lag[i] * (state[3, i] - rest[i])
            for i in range(joints):
                state[3, i] = rest[i]
                for j in range(joints):
                    state[3, i] += follow[i, j] * held[j]
        angle[n], arm[n] = state[0], state[3]
    return angle, torque, arm
