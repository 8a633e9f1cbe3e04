"""A stage's processor whose loops give the reference back, and a host that is a method call away."""

from typing import Any

import numpy as np

from firmware_sim.slcan_adapter import Frame
from firmware_sim.stage_processor import Loops, Settings, StageProcessor
from rigkit.wire.layout import Layout
from stagectl.wire import messages, samples
from stagectl.wire.messages import Command, Drive, Fault, HostState, State


class Bench:
    """A processor whose loops give the reference back, and a host that is a method call away."""

    def __init__(self, **settings: Any) -> None:
        self.now, self.fault, self.cleared = 100.0, Fault.NONE, 0
        self.references: list[np.ndarray] = []
        self.excited: tuple[Drive, int] | None = None
        self.loops = Loops(self.tick, self.commit, self.clear, self.excite, self.release)
        self.processor = StageProcessor(self.loops, Settings(**settings), self.now)
        self.frames: list[Frame] = []
        self._counter, self._token = 0, 0

    def tick(self, reference: np.ndarray) -> dict[str, Any]:
        self.references.append(reference.copy())
        position = reference if self.excited is None else reference * 1e-5
        return {"position": position, "extension": position / 5, "voltage": position * 1e5, "fault": self.fault}

    def commit(self, parameters: object) -> None:
        self.committed = parameters

    def clear(self) -> None:
        self.fault, self.cleared = Fault.NONE, self.cleared + 1

    def excite(self, drive: Drive, axis: int) -> None:
        if axis > 2:
            raise ValueError(f"axis is {axis}")
        self.excited = drive, axis

    def release(self) -> None:
        self.excited = None

    def say(self, layout: Layout, *values: int) -> None:
        self.processor.receive(Frame(layout.identifier, layout.pack(0, *values), layout.is_fd), self.now)

    def ask(self, command: Command, argument: int = 0, token: int | None = None) -> tuple[int, ...]:
        self._token = self._token + 1 if token is None else token
        self.say(messages.COMMAND, command, self._token, argument)
        self.step(0.0)
        return self.said(messages.REPLY)[-1]

    def step(self, seconds: float) -> None:
        self.now += seconds
        while frames := self.processor.advance(self.now):
            self.frames += frames

    def refer(self, value: float, skip: int = 0, layout: Layout = messages.REFERENCE) -> None:
        """Send a block of references, all equal, after leaving out `skip` blocks."""
        self._counter += 1 + skip
        data = samples.encode(layout, self._counter, np.full((10, 3), value))
        self.processor.receive(Frame(layout.identifier, data, True), self.now)

    def stream(
        self,
        blocks: int,
        value: float = 1e-5,
        state: HostState = HostState.STREAMING,
        layout: Layout = messages.REFERENCE,
    ) -> None:
        for _ in range(blocks):
            self.say(messages.HOST_HEARTBEAT, state, 0, 0)
            self.refer(value, layout=layout)
            self.step(1e-3)

    def said(self, layout: Layout) -> list[tuple[int, ...]]:
        return [layout.unpack(frame.data)[1] for frame in self.frames if frame.identifier == layout.identifier]

    def heartbeat(self) -> tuple[State, Fault]:
        state, fault, _ = self.said(messages.STAGE_HEARTBEAT)[-1]
        return State(state), Fault(fault)
