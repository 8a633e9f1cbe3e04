"""Requests as they come from the web process, and the answers: plain values, which JSON can carry."""

from collections.abc import Callable, Mapping
from typing import Any

from rigkit.faults import KINDS
from rigkit.service.control import Control
from rigkit.service.lease import Refused
from rigkit.service.state import NotNow

FAULT_OF_OURS = 500
_STATUS = ((Refused, 403), (NotNow, 409), (LookupError, 404), (ValueError, 422), (OSError, 503))
"""HTTP status by what was raised, the first that fits."""


class Commands:
    """What may be asked of the daemon, by name.

    Parameters
    ----------
    control : Control
    """

    def __init__(self, control: Control) -> None:
        self._control = control
        self._by_name: dict[str, Callable[..., Any]] = {
            "take_control": control.take_control,
            "renew": control.renew,
            "give_back": control.give_back,
            "arm": control.arm,
            "disarm": control.disarm,
            "begin": control.begin,
            "begun": control.begun,
            "hold": control.hold,
            "resume": control.resume,
            "abort": control.abort,
            "acknowledge": control.acknowledge,
            "reload": control.reload,
            "inject": control.inject,
            "stop": control.stop,
            "panel": control.board.panel,
            "events": control.journal.since,
            "settings": control.rig.settings,
            "rig": self._rig,
            "note": self._note,
        }

    def answer(self, request: Mapping[str, Any]) -> dict[str, Any]:
        """Carry out {"do": name, "with": arguments}.

        Returns
        -------
        dict
            {"status": 200, "told": ...}, or {"status": ..., "error": why nothing was done}.
        """
        try:
            told = self._by_name[request["do"]](**request["with"])
        except Exception as fault:
            status = next((status for kind, status in _STATUS if isinstance(fault, kind)), FAULT_OF_OURS)
            text = str(fault.args[0]) if isinstance(fault, LookupError) and fault.args else str(fault)
            return {"status": status, "error": text if status != FAULT_OF_OURS else f"{type(fault).__name__}: {text}"}
        return {"status": 200, "told": told}

    def _rig(self, role: str) -> dict[str, Any]:
        rig = self._control.rig
        procedures = [
            {
                "name": each.name,
                "title": each.title,
                "kind": each.kind,
                "unit": each.unit,
                "pausable": each.pausable,
                "on_pause": each.on_pause,
                "on_abort": each.on_abort,
                "options": each.options.model_json_schema(),
            }
            for each in rig.procedures
        ]
        sensors = [] if rig.faults is None else list(rig.faults.names)
        kinds = list(KINDS) if sensors else []
        told = {"program": rig.program, "rig": rig.name, "role": role, "procedures": procedures}
        return {**told, "fault_sensors": sensors, "fault_kinds": kinds}

    def _note(self, event: str, who: str, fields: Mapping[str, Any]) -> None:
        self._control.journal.add(event, who, fields)
