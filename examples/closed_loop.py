"""A loop in a graph: a PI controller holds a first-order plant at its reference; the result is a CSV file.

Run it:  python examples/closed_loop.py [FILE.csv]
"""

import sys
from pathlib import Path

import numpy as np

from ctlblocks import Block, Graph, Port
from ctlblocks.clock import run_offline
from ctlblocks.recording import write
from ctlblocks.replay import Record

RATE, SECONDS = 1000.0, 2.0


class Step(Block):
    """A step of one metre, after 0.1 s."""

    outputs = (Port("position", "m"),)

    def prepare(self, rate: float, frames: int) -> None:
        """Start before the step."""
        self.wait = round(0.1 * rate)

    def process(self, position: np.ndarray) -> None:
        """Emit one sample."""
        self.wait -= 1
        position.fill(float(self.wait < 0))


class Controller(Block):
    """Proportional and integral action, in physical parameters: what depends on the rate is computed in `prepare`."""

    inputs = (Port("reference", "m"), Port("position", "m"))
    outputs = (Port("drive", "V"),)
    gain, integral_time, limit = 3.0, 0.2, 2.0  # V/m, s, V

    def prepare(self, rate: float, frames: int) -> None:
        """Forget the past."""
        self.step, self.integral = 1.0 / (rate * self.integral_time), 0.0

    def process(self, reference: np.ndarray, position: np.ndarray, drive: np.ndarray) -> None:
        """Compute one sample."""
        error = reference.item() - position.item()
        self.integral += self.step * error
        drive.fill(min(max(self.gain * (error + self.integral), -self.limit), self.limit))


class Plant(Block):
    """One metre per volt, with a time constant of 0.3 s."""

    inputs = (Port("drive", "V"),)
    outputs = (Port("position", "m"),)

    def prepare(self, rate: float, frames: int) -> None:
        """Start at rest."""
        self.pole, self.position = np.exp(-1.0 / (0.3 * rate)), 0.0

    def process(self, drive: np.ndarray, position: np.ndarray) -> None:
        """Move for one sample."""
        self.position += (1.0 - self.pole) * (drive.item() - self.position)
        position.fill(self.position)


def loop() -> tuple[Graph, Record]:
    """Return the loop, and the block that records it.  The one delayed wire says where a sample is lost."""
    record = Record([Port("position", "m"), Port("drive", "V")], round(RATE * SECONDS))
    graph = Graph(RATE)
    graph.add("reference", Step())
    graph.add("controller", Controller())
    graph.add("plant", Plant())
    graph.add("record", record)
    graph.connect("reference.position", "controller.reference")
    graph.connect("plant.position", "controller.position", delayed=True)
    graph.connect("controller.drive", "plant.drive")
    graph.connect("plant.position", "record.position")
    graph.connect("controller.drive", "record.drive")
    return graph, record


def main(file: Path) -> None:
    """Run the loop as fast as it goes, and write what happened."""
    graph, record = loop()
    graph.prepare()
    run_offline(graph, round(RATE * SECONDS))
    write(file, record.recording({"from": "examples/closed_loop.py"}))
    position = record.recording().select(["position"]).data
    print(f"{file}: position {position[-1, 0]:.4f} m after {SECONDS:g} s, overshoot {position.max() - 1:.1%}")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "closed_loop.csv"))
