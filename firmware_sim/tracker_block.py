"""The optical tracker as a block: what it sends of spindle and workpiece, as numbers instead of bytes."""

from collections import deque
from dataclasses import dataclass
from math import ceil

import numpy as np

from ctlblocks.block import Block, Port
from firmware_sim.guided_robot import NEVER
from firmware_sim.plants.options import option, refuse_wrong_options
from firmware_sim.tracker import LEDS, TrackerFaults

SEEN = np.array([3, 4])
"""LEDs on the spindle and on the workpiece [Sörnmo 2015, sec. 2.2]."""
FREEDOM = (3 * SEEN - 6).tolist()
"""Of their residuals."""
PARTS = slice(0, 1), slice(1, 2), slice(2, 9), slice(9, 16), slice(16, 18), slice(18, 20)
"""Of what is sent: counter, stamp, both poses, LEDs, residuals."""
WAVES, LENGTHS = 4, (0.5, 2.0)
"""Of the error that stays in a place: how many on each axis, and how long, m; what cameras' calibration leaves is as
long as their volume."""


@dataclass(eq=False, kw_only=True)
class TrackerView(Block):
    """A tracker that sees the spindle on the stage and the workpiece on the robot, at a rate of its own.

    What it does wrong is as in `TrackerFaults`.  Each LED has white noise, of which a frame's pose has the mean, and
    the volume is warped a little: an error that stays in a place, as long waves.  It does not model: exposure of LEDs
    one after the other, LEDs that are seen worse at some angles.

    Ports: `tool` (m, 3), where the stage has the tool, `workpiece` (m, 3) and `orientation` (1, 4) of the robot's tool
    in; `sample` (1), its counter, `stamp` (s), its clock, `spindle` and `workpiece_seen` (1, 7: m and w x y z), and for
    both `leds` and `residual` (1, 2; m) out.  Outputs hold the newest sample.

    Parameters
    ----------
    seed : int
    sample_rate : float, samples/s
    delay : float, s, from what it sees to what it says
    noise : float, m rms, of each LED in each axis
    warp : float, m rms in each axis, over the volume
    lost, unseen : float, 0 to 1, part of the samples
    blind, blind_for : float, s, when it begins to see nothing, and for how long
    jump_at, jump : float, s and m, when an LED of the workpiece is taken for another, and how far off that is
    run : int
        Which run beside the same cameras: from 1 on noise and losses are others, the volume's warp is not.
    """

    seed: int = option(1, "", 0)
    sample_rate: float = option(440.0, "Hz", 10.0, 1_000.0)
    delay: float = option(0.004, "s", 0.0, 0.1)
    noise: float = option(TrackerFaults.noise, "m", 0.0, 1e-2)
    warp: float = option(40e-6, "m", 0.0, 1e-2)
    lost: float = option(TrackerFaults.lost, "1", 0.0, 1.0)
    unseen: float = option(TrackerFaults.unseen, "1", 0.0, 1.0)
    blind: float = option(NEVER, "s", 0.0)
    blind_for: float = option(1.0, "s", 0.0)
    jump_at: float = option(NEVER, "s", 0.0)
    jump: float = option(5e-3, "m", 0.0, 1.0)
    run: int = option(0, "", 0)

    def __post_init__(self) -> None:
        """Refuse what is out of range, and lay out the ports."""
        refuse_wrong_options(self)
        self.inputs = (Port("tool", "m", 3), Port("workpiece", "m", 3), Port("orientation", "1", 4))
        self.outputs = (
            Port("sample"), Port("stamp", "s"), Port("spindle", "1", 7), Port("workpiece_seen", "1", 7),
            Port("leds", "1", 2), Port("residual", "m", 2),
        )  # fmt: skip

    def prepare(self, rate: float, frames: int) -> None:
        """Begin to count, with nothing seen."""
        self._rng = np.random.default_rng([self.seed, 440])
        wave = self._rng.standard_normal((3, WAVES, 3))
        wave *= 2 * np.pi / self._rng.uniform(*LENGTHS, (3, WAVES, 1)) / np.linalg.norm(wave, axis=2, keepdims=True)
        self._warp = wave, self._rng.uniform(0, 2 * np.pi, (3, WAVES)), self.warp * np.sqrt(2 / WAVES)
        if self.run:
            self._rng = np.random.default_rng([self.seed, 440, self.run])
        self._rate, self._late = rate, round(self.delay * rate)
        self._done, self._counter, self._next = 0, 0, 0
        self._sent: deque[tuple[int, np.ndarray]] = deque()
        self._shown, self._draws = np.zeros(20), np.zeros(12 + sum(FREEDOM))

    def process(
        self,
        tool: np.ndarray,
        workpiece: np.ndarray,
        orientation: np.ndarray,
        sample: np.ndarray,
        stamp: np.ndarray,
        spindle: np.ndarray,
        workpiece_seen: np.ndarray,
        leds: np.ndarray,
        residual: np.ndarray,
    ) -> None:
        """Look on for one frame."""
        outputs = sample, stamp, spindle, workpiece_seen, leds, residual
        n = 0
        while n < len(tool):  # from event to event: it looks, or what it saw arrives
            if self._done == self._next:
                self._look(tool[n], workpiece[n], orientation[n])
            while self._sent and self._sent[0][0] <= self._done:
                self._shown = self._sent.popleft()[1]
            until = min(self._next, self._sent[0][0] if self._sent else self._next)
            now = slice(n, min(len(tool), n + until - self._done))
            for output, part in zip(outputs, PARTS, strict=True):
                output[now] = self._shown[part]
            self._done += now.stop - n
            n = now.stop

    def _look(self, tool: np.ndarray, workpiece: np.ndarray, orientation: np.ndarray) -> None:
        """See what is there now, and send it, unless it is lost on its way."""
        self._counter += 1
        self._next = ceil(self._counter * self._rate / self.sample_rate)
        time, draw = self._done / self._rate, self._rng.random(3)
        self._rng.standard_normal(out=self._draws)
        noise = self.noise * self._draws[:12].reshape(2, 6) / np.sqrt(SEEN)[:, None]
        misfits = np.split(self._draws[12:], FREEDOM[:1])  # Generator.chisquare of an array keeps memory at each call
        if draw[0] < self.lost:
            return
        told = np.zeros(20)
        told[:2] = self._counter, time
        poses = told[2:16].reshape(2, 7)
        wave, phase, size = self._warp
        poses[:, 3], poses[0, :3] = 1.0, tool
        poses[1] = *(workpiece + size * np.sin(wave @ workpiece + phase).sum(axis=1)), *orientation
        poses[:, :3] += noise[:, :3]
        poses[1, 0] += self.jump if time >= self.jump_at else 0.0
        for pose, turn in zip(poses, noise[:, 3:] / TrackerFaults.radius, strict=True):
            _turn(pose[3:], 0.5 * turn)
        is_blind = self.blind <= time < self.blind + self.blind_for
        told[16:18] = np.where((draw[1:] < self.unseen) | is_blind, LEDS - 1, SEEN)
        told[18:] = [self.noise * np.sqrt(misfit @ misfit / len(misfit)) for misfit in misfits]
        self._sent.append((self._done + self._late, told))


def _turn(quaternion: np.ndarray, half: np.ndarray) -> None:
    """Turn a unit quaternion (4,) by twice a small vector `half`, shape (3,), rad, in the base, in place."""
    (w, x, y, z), (a, b, c) = quaternion.tolist(), half.tolist()
    quaternion[:] = (
        w - a * x - b * y - c * z,
        x + a * w + b * z - c * y,
        y + b * w + c * x - a * z,
        z + c * w + a * y - b * x,
    )
    quaternion /= np.sqrt(quaternion @ quaternion)
