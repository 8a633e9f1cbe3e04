"""How an experiment is registered: once, by the places of its code, none of which is imported before it is called."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Served:
    """How something is a procedure of the daemon.

    Parameters
    ----------
    title, unit, on_abort, on_pause, kind
        As of `rigkit.service.rig.Procedure`; one without `on_pause` cannot be paused.
    options : str
        "module:Class", the `Section` it may be begun with.
    maker : str
        "module:name", found when it begins: called with (config, options, desk), it returns what runs.
    """

    title: str
    unit: str
    on_abort: str
    options: str
    maker: str
    on_pause: str = ""
    kind: Literal["calibrate", "run"] = "run"


@dataclass(frozen=True)
class Registration:
    """An experiment.

    Parameters
    ----------
    name : str
        Of its command, and of its procedure under the daemon.
    what, page : str
        What it is, in a few words, and the page of docs/ that says more.
    command : str
        "module:function".
    kind : str
        "module:NAME" of its `rigkit.experiment.kind.Kind`; empty where the one runner does not run it.
    served : Served or None
        None where the daemon does not.
    """

    name: str
    what: str
    page: str
    command: str
    kind: str = ""
    served: Served | None = None
