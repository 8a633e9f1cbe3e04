"""A trial: play a drive once while its response is recorded; and the one graph in which that happens."""

import numpy as np

from ctlblocks.block import Block, Port
from ctlblocks.graph import Graph
from vibractl.guard import Guard


class Trial(Block):
    """Play `drive` and record `response`, both preallocated, from position 0; silence after the end.

    Ports: `response` (m/s^2) in, `drive` (V) out.

    Parameters
    ----------
    drive : array, shape (samples, drives), V
        Played as it is in memory at the moment of playing: a learner may write the next one into it.
    responses : int, accelerometers, >= 1
    margin : int, samples, >= 0
        Recorded beyond the drive's length, for latency and ring-down.
    """

    def __init__(self, drive: np.ndarray, responses: int, margin: int = 0) -> None:
        if drive.ndim != 2 or margin < 0 or responses < 1:
            raise ValueError(
                f"drive has shape {drive.shape}, responses is {responses}, margin is {margin}: "
                "must be (samples, drives), >= 1 and >= 0"
            )
        self.inputs = (Port("response", "m/s^2", responses),)
        self.outputs = (Port("drive", "V", drive.shape[1]),)
        self.drive = drive
        self.response = np.zeros((len(drive) + margin, responses))
        self.position = 0

    def prepare(self, rate: float, frames: int) -> None:
        """Go back to position 0 and forget what was recorded."""
        self.response.fill(0.0)
        self.rewind()

    def process(self, response: np.ndarray, drive: np.ndarray) -> None:
        """Play and record one frame."""
        start, frames = self.position, len(drive)
        played = min(max(len(self.drive) - start, 0), frames)
        recorded = min(max(len(self.response) - start, 0), frames)
        drive[:played] = self.drive[start : start + played]
        drive[played:] = 0.0
        self.response[start : start + recorded] = response[:recorded]
        self.position = start + frames

    def rewind(self) -> None:
        """Play and record from position 0 again (between ticks)."""
        self.position = 0

    def park(self) -> None:
        """Play and record nothing until `rewind` (between ticks)."""
        self.position = len(self.response)

    def load(self, drive: np.ndarray, response: np.ndarray) -> None:
        """Take other memory to play from and record into (between ticks); silent until `rewind`.

        Parameters
        ----------
        drive : array, shape (samples, drives), V
        response : array, shape (at least samples, responses), m/s^2

        Raises
        ------
        ValueError : the widths are not those of the ports, or the response is shorter than the drive.
        """
        drives, responses = self.outputs[0].width, self.inputs[0].width
        if drive.shape[1:] != (drives,) or response.shape[1:] != (responses,) or len(response) < len(drive):
            raise ValueError(
                f"drive has shape {drive.shape} and response {response.shape}, must be (samples, {drives}) "
                f"and (at least as many, {responses})"
            )
        self.drive, self.response = drive, response
        self.park()

    @property
    def done(self) -> bool:
        """Whether everything is played and recorded."""
        return self.position >= len(self.response)


class FrameInput(Block):
    """The frame that an audio callback, or a replay, has filled, as a signal.

    Ports: `response` (m/s^2) out.

    Parameters
    ----------
    width : int, accelerometers, >= 1
    """

    def __init__(self, width: int) -> None:
        self.outputs = (Port("response", "m/s^2", width),)
        self.frame = np.zeros((0, width))

    def prepare(self, rate: float, frames: int) -> None:
        """Allocate the frame, silent."""
        self.frame = np.zeros((frames, self.outputs[0].width))

    def process(self, response: np.ndarray) -> None:
        """Hand the frame on."""
        np.copyto(response, self.frame)


def shot_graph(source: Block, trial: Trial, guard: Guard, rate: float, frames: int) -> Graph:
    """Wire a source's `response` to the trial and the trial's drive to the guard.

    It is the graph of a live shot, where the audio callback fills the source's frame and reads `guard.output`, and of
    a replay, which fills it from a recording.

    Parameters
    ----------
    source : Block
        With an output `response`, m/s^2, as wide as the trial's.
    trial : Trial
    guard : Guard
    rate : float, samples/s
    frames : int, samples a tick

    Returns
    -------
    Graph
        With the blocks `source`, `trial` and `guard`, not prepared.
    """
    graph = Graph(rate, frames)
    graph.add("source", source)
    graph.add("trial", trial)
    graph.add("guard", guard)
    graph.connect("source.response", "trial.response")
    graph.connect("trial.drive", "guard.request")
    return graph
