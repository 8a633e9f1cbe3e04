"""The audio interface, held against other programs by what it is, whatever it is called."""

import re
import sys
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, Self

from rigkit.machine_lock import MachineLock
from vibractl.audio_stream import AudioError, class_of
from vibractl.config import Audio

OPEN_FILES = Path("/proc/self/fd")
"""Links to the files that this process has open, on Linux."""
_HARDWARE = re.compile(r"\bhw:(\d+),(\d+)")
_OPEN = re.compile(r"/dev/snd/pcmC(\d+)D(\d+)[pc]")


class HeldDevice:
    """Take the audio interface from whoever else would open it; a context manager that lets others have it.

    A stream that is all within this process, which says so by `in_process`, is nobody else's.

    Parameters
    ----------
    audio : Audio

    Raises
    ------
    AudioError : another process has it, or there is no such stream.
    """

    def __init__(self, audio: Audio) -> None:
        found, self._held = class_of(audio), ExitStack()
        self._names: set[str] = set()
        self._is_shared = not getattr(found, "in_process", False)
        if self._is_shared:
            self._take(set(_called(sys.modules[found.__module__], audio)))

    def take_opened(self, stream: Any) -> None:
        """Take what a stream has opened that is not started yet: an alias, such as ALSA's default, may be any card.

        Raises
        ------
        AudioError : another process has it; the stream is closed.
        """
        try:
            self._take(set(_opened()) if self._is_shared else set())
        except AudioError:
            stream.close()
            raise

    def release(self) -> None:
        """Let others have it; may be called twice."""
        self._held.close()

    def __enter__(self) -> Self:
        """Return it."""
        return self

    def __exit__(self, *_: object) -> None:
        """Let others have it."""
        self.release()

    def _take(self, names: set[str]) -> None:
        try:
            for name in sorted(names - self._names):
                self._held.callback(MachineLock(name).release)
                self._names.add(name)
        except OSError as fault:
            self.release()
            raise AudioError(str(fault)) from None


def _called(module: Any, audio: Audio) -> Iterator[str]:
    """Yield what the interface is, by what the library that opens it says of the name in the rig file."""
    query = getattr(module, "query_devices", None)
    if query is not None:
        with suppress(Exception):  # no such device: opening it says so better
            yield from {_name(module, query(audio.device or None, kind)) for kind in ("input", "output")}
            return
    yield f"audio device {audio.device or 'default'} of {audio.stream.partition(':')[0]}"


def _name(module: Any, told: dict[str, Any]) -> str:
    """Return what a device of PortAudio is: hardware by its number, else by its name and which of that name it is."""
    if found := _HARDWARE.search(told["name"]):
        return _hardware(*found.groups())
    alike = [each["index"] for each in module.query_devices() if _kind(each) == _kind(told)]
    which = f" ({alike.index(told['index']) + 1} of {len(alike)})" if len(alike) > 1 else ""
    return f"audio device {told['name']} of {module.query_hostapis(told['hostapi'])['name']}{which}"


def _kind(told: dict[str, Any]) -> tuple[Any, ...]:
    return told["name"], told["hostapi"]


def _opened() -> Iterator[str]:
    """Yield the sound hardware that this process has open."""
    with suppress(OSError):  # not Linux
        for link in OPEN_FILES.iterdir():
            with suppress(OSError):  # closed in the meantime
                if found := _OPEN.fullmatch(str(link.readlink())):
                    yield _hardware(*found.groups())


def _hardware(card: str, device: str) -> str:
    return f"audio device hw:{card},{device}"
