"""Online and offline are one graph: what a timer recorded in real time, a replay of the inputs gives bit for bit.

Run it:  python examples/replay_bit_for_bit.py [FILE.wav]
"""

import sys
from pathlib import Path

import numpy as np

from ctlblocks import Block, Graph, Port
from ctlblocks.basic import Gain
from ctlblocks.clock import Timer, run_offline
from ctlblocks.recording import read, write
from ctlblocks.replay import Record, Replay

RATE, FRAMES, TICKS = 8000.0, 80, 20


class Microphone(Block):
    """What a rig would hear: noise."""

    outputs = (Port("pressure", "Pa"),)

    def prepare(self, rate: float, frames: int) -> None:
        """Plug it in."""
        self.random = np.random.default_rng()

    def process(self, pressure: np.ndarray) -> None:
        """Hear one frame."""
        self.random.standard_normal(out=pressure)


class Leaky(Block):
    """A first-order low-pass that remembers its last output from one frame to the next."""

    inputs = (Port("signal", "V"),)
    outputs = (Port("smooth", "V"),)

    def prepare(self, rate: float, frames: int) -> None:
        """Forget the past."""
        self.pole, self.last = np.exp(-2.0 * np.pi * 50.0 / rate), 0.0

    def process(self, signal: np.ndarray, smooth: np.ndarray) -> None:
        """Smooth one frame."""
        for place, value in enumerate(signal[:, 0]):
            self.last += (1.0 - self.pole) * (value - self.last)
            smooth[place] = self.last


def rig(source: Block) -> tuple[Graph, Record]:
    """Return the graph of the rig behind a source of `pressure`, and the block that records it."""
    record = Record([Port("pressure", "Pa"), Port("drive", "V")], FRAMES * TICKS)
    graph = Graph(RATE, FRAMES)
    graph.add("source", source)
    graph.add("gain", Gain(-0.3, "Pa", "V"))
    graph.add("leaky", Leaky())
    graph.add("record", record)
    graph.connect("source.pressure", "gain.signal")
    graph.connect("gain.scaled", "leaky.signal")
    graph.connect("source.pressure", "record.pressure")
    graph.connect("leaky.smooth", "record.drive")
    graph.prepare()
    return graph, record


def main(file: Path) -> None:
    """Record in real time, write, read, replay, compare."""
    graph, record = rig(Microphone())
    timer = Timer(graph, zeroed=["leaky.smooth"])
    timer.run(TICKS)
    write(file, record.recording({"from": "examples/replay_bit_for_bit.py"}))
    recorded = read(file, rate=RATE, names=["pressure", "drive"])
    graph, record = rig(Replay(recorded, {"pressure": ["pressure"]}))
    run_offline(graph, TICKS)
    same = record.recording().data.tobytes() == recorded.data.tobytes()
    print(
        f"{file}: {len(recorded.data)} samples, {timer.late} ticks late, replayed {'' if same else 'NOT '}bit for bit"
    )


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "replay.wav"))
