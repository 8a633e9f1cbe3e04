"""One file for whoever is asked for help: machine, libraries, devices, verdicts, settings without names."""

import io
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from rigkit import atomic
from rigkit.code_name import resolve
from rigkit.json_text import json_text
from rigkit.machine_facts import machine_facts
from rigkit.redacted import Redaction
from rigkit.verdict import Verdict

SUFFIX = ".zip"
CONTENT = {
    "verdicts.json": "each verdict of the doctor with its figures and advice",
    "machine.json": "versions, system, processor, memory, load, clock and how exactly it sleeps; versions of libraries",
    "devices.json": "devices that the system lists, or why it lists none",
}
"""What is in the file beside the settings."""
_DATE = (1980, 1, 1, 0, 0, 0)


def write_issue_file(
    path: Path, settings: Mapping[str, BaseModel], verdicts: Sequence[Verdict], list_devices: str
) -> list[str]:
    """Write the file; return a line for each part, which says what is in it.

    Parameters
    ----------
    path : Path
        A .zip file.
    settings : mapping of str to Section
        By the name that each has in the file, such as rig.toml.
    verdicts : sequence of Verdict
    list_devices : str
        "module:function", which lists the devices of the kind that matters.
    """
    redaction = Redaction()
    parts = {name: redaction.config(config) for name, config in settings.items()}
    parts["verdicts.json"] = json_text([each.figures() for each in verdicts], indent=2)
    parts["machine.json"] = json_text(machine_facts(), indent=2)
    parts["devices.json"] = json_text(_devices(list_devices), indent=2)
    said = dict.fromkeys(settings, "the settings; names, paths, addresses and devices are replaced by <key>") | CONTENT
    lines = [f"{name}: {said[name]}" for name in parts]
    parts["README.txt"] = "\n".join(["Written by the doctor, for a question or an issue.", "", *lines, ""])
    memory = io.BytesIO()
    with zipfile.ZipFile(memory, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in parts.items():
            archive.writestr(zipfile.ZipInfo(name, _DATE), redaction.text(text))
    atomic.write(path, memory.getvalue())
    return lines


def _devices(list_devices: str) -> Any:
    """Return what the system lists, as plain values, or one line why it does not."""
    try:
        found = resolve(list_devices)()
    except Exception as fault:  # of libraries and drivers of others, and this is to be written above all then
        return f"{type(fault).__name__}: {fault}"
    return [dict(each) if isinstance(each, Mapping) else str(each) for each in found]
