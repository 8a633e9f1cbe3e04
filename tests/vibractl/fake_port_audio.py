"""PortAudio as sounddevice calls it, with devices that a test names."""

from collections.abc import Sequence
from types import SimpleNamespace


class FakePortAudio:
    """The functions of the library by which sounddevice looks for devices.

    Parameters
    ----------
    hosts : sequence of str
        Names of the host APIs.
    devices : sequence of (str, int)
        Name of each device, and which host API it is of; all have eight inputs and outputs.
    default : int
        Which device the default is.
    """

    def __init__(self, hosts: Sequence[str], devices: Sequence[tuple[str, int]], default: int = 0) -> None:
        self._hosts, self._devices, self._default = hosts, devices, default

    def Pa_GetDeviceCount(self) -> int:  # noqa: N802
        return len(self._devices)

    def Pa_GetDefaultInputDevice(self) -> int:  # noqa: N802
        return self._default

    def Pa_GetDefaultOutputDevice(self) -> int:  # noqa: N802
        return self._default

    def Pa_GetDeviceInfo(self, index: int) -> SimpleNamespace:  # noqa: N802
        name, host = self._devices[index]
        times = {f"default{size}{way}Latency": 0.0 for size in ("Low", "High") for way in ("Input", "Output")}
        widths = {"maxInputChannels": 8, "maxOutputChannels": 8, "defaultSampleRate": 44_100.0}
        return SimpleNamespace(structVersion=2, name=name.encode(), hostApi=host, **widths, **times)

    def Pa_GetHostApiInfo(self, index: int) -> SimpleNamespace:  # noqa: N802
        name = self._hosts[index].encode()
        return SimpleNamespace(
            structVersion=1, name=name, deviceCount=0, defaultInputDevice=self._default, defaultOutputDevice=0
        )
