"""The command `vibractl devices`."""

from collections.abc import Mapping, Sequence
from typing import Any

from rigkit import config as rig_file
from rigkit.code_name import resolve
from rigkit.command import ConfigOption, JsonOption, SetOption, print_table, words, write_json
from vibractl.audio_stream import AudioError, channels
from vibractl.config import RigConfig

LIBRARY = "sounddevice"
HEAD = ("number", "name", "driver", "inputs", "outputs", "samples/s", "enough channels")
NONE = (
    "the system lists no audio device: is the interface connected and switched on, does `aplay -l` show it, and are "
    "you in the group audio?  The simulated vibrator needs none\n"
)


def devices_command(config: ConfigOption = None, settings: SetOption = None, json: JsonOption = None) -> None:
    """List the audio devices: names for `audio.device`, channels, and which have enough for the rig file.

    Nothing is opened or played.  Which channels a rig needs, its file says: without one, three in and three out, of
    two coils, two accelerometers and the loopback cable.

    Example: `vibractl devices --config rig.toml`
    """
    rig = rig_file.load(config, RigConfig, settings or ())
    inputs, outputs = channels(rig.audio)
    found = [_figures(*each, inputs, outputs) for each in _listed()]
    stream, needed = words(json), f"the rig file needs {inputs} inputs and {outputs} outputs of one device"
    if found:
        rows = [[*map(str, list(each.values())[:-1]), "yes" if each["enough"] else "no"] for each in found]
        print_table(f"audio devices; {needed}", HEAD, rows, stream)
        stream.write('in the rig file: audio.stream = "sounddevice:Stream", audio.device = the name; then the doctor\n')
    else:
        stream.write(NONE)
    write_json(json, {"inputs": inputs, "outputs": outputs, "devices": found})


def _figures(told: Mapping[str, Any], driver: str, inputs: int, outputs: int) -> dict[str, Any]:
    there = told["max_input_channels"], told["max_output_channels"]
    return {
        "number": told["index"],
        "name": told["name"],
        "driver": driver,
        "inputs": there[0],
        "outputs": there[1],
        "rate": f"{told['default_samplerate']:g}",
        "enough": there[0] >= inputs and there[1] >= outputs,
    }


def _listed() -> Sequence[tuple[Mapping[str, Any], str]]:
    """Return what PortAudio lists, each with the name of its driver."""
    try:
        drivers = resolve(f"{LIBRARY}:query_hostapis")()
        return [(each, drivers[each["hostapi"]]["name"]) for each in resolve(f"{LIBRARY}:query_devices")()]
    except (OSError, ValueError) as fault:
        hint = "; on Debian: apt-get install libportaudio2" if "PortAudio" in str(fault) else ""
        raise AudioError(f"audio devices cannot be listed: {fault}{hint}") from None
