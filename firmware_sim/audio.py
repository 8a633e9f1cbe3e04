"""A simulated audio card under `sounddevice.Stream`'s constructor and contract, with a laboratory behind it."""

import functools
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterable
from typing import Any, Self

from firmware_sim.card import CONVERTER_DELAY, Card
from firmware_sim.faults import Fault
from firmware_sim.laboratory import Laboratory, Wiring, plant_block

DEVICE = "simulated"
BLOCKSIZE = 512
RATE = 44_100.0


class CallbackStop(Exception):
    """Raised by a callback to end the stream after this block; sounddevice's own is honoured as well."""


class CallbackAbort(Exception):
    """Raised by a callback to end the stream at once; sounddevice's own is honoured as well."""


class Stream:
    """A full-duplex stream on a simulated card, paced by the monotonic clock; the parameters are sounddevice's.

    The plant's time advances with the callbacks and with nothing else: a late callback moves time, never data.

    Not modelled: a converter's noise and filters, clocks that drift, more than one device.

    Parameters
    ----------
    samplerate : float, samples/s
        44 100 when None.
    blocksize : int, samples a callback
        512 when None or 0.
    device : str, int or None
        "simulated", 0, or None for the default, which is the same.
    channels : int or (int, int), inputs and outputs
        At most as many as are wired; all of them when None.
    dtype : str or (str, str)
        "float32".
    latency, extra_settings, clip_off, dither_off, never_drop_input, prime_output_buffers_using_stream_callback
        Taken and ignored: there is nothing to choose on this card.
    callback : callable(indata, outdata, frames, time, status)
        Required: there is no blocking read and write.
    finished_callback : callable()
    laboratory : Laboratory
        The default vibrator, wired by default, when None.
    speed : float, times real time, > 0
    faults : iterable of Fault
    """

    in_process = True
    """Each one is a card of its own: two programs that open it do not meet."""

    def __init__(
        self,
        samplerate: float | None = None,
        blocksize: int | None = None,
        device: Any = None,
        channels: Any = None,
        dtype: Any = None,
        latency: Any = None,
        extra_settings: Any = None,
        callback: Callable[..., None] | None = None,
        finished_callback: Callable[[], None] | None = None,
        clip_off: bool | None = None,
        dither_off: bool | None = None,
        never_drop_input: bool | None = None,
        prime_output_buffers_using_stream_callback: bool | None = None,
        *,
        laboratory: Laboratory | None = None,
        speed: float = 1.0,
        faults: Iterable[Fault] = (),
    ) -> None:
        if callback is None:
            raise ValueError("callback is None, must be given: the simulated card has no blocking read and write")
        laboratory = laboratory or Laboratory(plant_block("vibrator", {}), Wiring())
        self.samplerate, self.blocksize = float(samplerate or RATE), blocksize or BLOCKSIZE
        self.channels = _channels(channels, laboratory.wiring)
        _refuse(device not in (None, 0, DEVICE, (DEVICE, DEVICE)), "device", device, repr(DEVICE))
        _refuse(dtype not in (None, "float32", ("float32", "float32")), "dtype", dtype, "'float32'")
        self.device, self.dtype, self.samplesize = (0, 0), ("float32", "float32"), (4, 4)
        self.latency = 0.0, (self.blocksize + CONVERTER_DELAY) / self.samplerate
        self.card = Card(laboratory, self.samplerate, self.blocksize, self.channels, faults)
        self._callback, self._finished, self._speed = callback, finished_callback, speed
        self._thread: threading.Thread | None = None
        self._halt = threading.Event()
        self._cause: BaseException | None = None
        self.active, self.stopped, self.closed = False, True, False

    @classmethod
    def from_config(cls, config: Any) -> Callable[..., "Stream"]:
        """Return the constructor for a rig file: `[simulator]` behind a card wired as `[audio]` says.

        Parameters
        ----------
        config : any object with the attributes `audio` and `simulator` of a rig file

        Returns
        -------
        callable with sounddevice.Stream's parameters
            It makes a `SteppedStream` when `simulator.speed` is 0, else a `Stream`.
        """
        audio, simulator = config.audio, config.simulator
        wiring = Wiring.of(audio)
        laboratory = Laboratory(plant_block(simulator.plant, dict(simulator.options)), wiring)
        if simulator.speed == 0:
            return functools.partial(SteppedStream, laboratory=laboratory)
        return functools.partial(cls, laboratory=laboratory, speed=simulator.speed)

    @property
    def time(self) -> float:
        """The stream's clock, s."""
        return self.card.time

    @property
    def cpu_load(self) -> float:
        """Not measured: 0."""
        return 0.0

    def start(self) -> None:
        """Call back from now on."""
        if self.closed:
            raise ValueError("the stream is closed, must be open to be started")
        if self.stopped:
            self.active, self.stopped, self._cause = True, False, None
            self._halt.clear()
            self._begin()

    def stop(self, ignore_errors: bool = True) -> None:
        """Call back no more, once the block under way is played."""
        self._halt.set()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join()
        self._end()
        self.stopped = True

    def abort(self, ignore_errors: bool = True) -> None:
        """Call back no more; a block is never divided, so this is `stop`."""
        self.stop(ignore_errors)

    def close(self, ignore_errors: bool = True) -> None:
        """Stop for good."""
        self.stop(ignore_errors)
        self.closed = True

    def __enter__(self) -> Self:
        """Start."""
        self.start()
        return self

    def __exit__(self, *fault: object) -> None:
        """Stop and close."""
        self.close()

    def _begin(self) -> None:
        self._thread = threading.Thread(target=self._run, name="simulated card", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        period = self.blocksize / self.samplerate / self._speed
        due = time.monotonic()
        while not self._halt.wait(max(0.0, due - time.monotonic())) and self._exchange():
            due = max(due + period, time.monotonic() - 1.0)
        self._end()

    def _exchange(self) -> bool:
        """Run one block; return whether the stream goes on."""
        portaudio = sys.modules.get("sounddevice")
        wanted: tuple[type[BaseException], ...] = (CallbackStop, CallbackAbort)
        if portaudio is not None:
            wanted += (portaudio.CallbackStop, portaudio.CallbackAbort)
        try:
            self.card.exchange(self._callback)
        except wanted:
            return False
        except Exception:
            traceback.print_exc()  # as cffi does: the caller of a callback is nobody's code
            return False
        return True

    def _end(self) -> None:
        if self.active:
            self.active = False
            if self._finished is not None:
                self._finished()


class SteppedStream(Stream):
    """The same card without a clock: it runs when `advance` is called, as fast as it goes."""

    def advance(self, frames: int) -> None:
        """Run the callback for the next `frames` samples, in whole blocks, unless the stream has ended.

        Parameters
        ----------
        frames : int, samples, >= 0
        """
        for _ in range(-(-frames // self.blocksize)):
            if not self.active:
                return
            if not self._exchange():
                self._end()

    def _begin(self) -> None:
        """Wait for `advance`."""


def _refuse(wrong: bool, name: str, value: object, allowed: str) -> None:
    if wrong:
        raise ValueError(f"{name} is {value!r}, must be {allowed}, on the simulated card")


def _channels(channels: Any, wiring: Wiring) -> tuple[int, int]:
    """Return input and output channels, at most those wired."""
    if channels is None:
        return wiring.inputs, wiring.outputs
    inputs, outputs = channels if isinstance(channels, tuple | list) else (channels, channels)
    _refuse(not 1 <= inputs <= wiring.inputs, "input channels", inputs, f">= 1 and <= {wiring.inputs}")
    _refuse(not 1 <= outputs <= wiring.outputs, "output channels", outputs, f">= 1 and <= {wiring.outputs}")
    return inputs, outputs
