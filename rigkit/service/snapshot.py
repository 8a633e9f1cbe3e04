"""What the daemon shows 25 times a second: state, owner of control, progress and gauges, as JSON."""

from datetime import UTC, datetime
from typing import Any

from rigkit.json_text import json_text
from rigkit.service.control import Control
from rigkit.service.journal import now
from rigkit.service.not_begun import reason
from rigkit.service.show import Output, output
from rigkit.service.state import State

RATE = 25.0
"""Snapshots a second."""


def snapshot(control: Control, tick: int, late: int, monotonic: float) -> dict[str, Any]:
    """Return what there is to show now; docs/service.md says what each part means.

    Parameters
    ----------
    control : Control
    tick : int
        Number of the snapshot.
    late : int
        How many were more than half a period late.
    monotonic : float, s
    """
    with control.changing:
        machine, desk, holder = control.machine, control.desk, control.lease.holder(monotonic)
        state = {
            "name": machine.state.value,
            "since": datetime.fromtimestamp(control.since, UTC).isoformat(timespec="milliseconds"),
            "who": machine.last.who,
            "why": machine.last.why,
            "ending": machine.ending,
        }
        allowed = machine.allowed()
        owner = holder and {"who": holder.who, "seconds": holder.until - monotonic}
    procedure = None if desk is None else desk.plain()
    put_out, gauges = _measured(control)
    return {
        "tick": tick,
        "time": now(),
        "program": control.rig.program,
        "rig": control.rig.name,
        "state": state,
        "allowed": allowed,
        "control": owner,
        "faults": {} if control.rig.faults is None else control.rig.faults.present(),
        "recording": desk is not None and desk.is_recording,
        "procedure": procedure,
        "output": put_out,
        "gauges": gauges,
        "panels": control.board.revisions(),
        "events": control.journal.number,
        "journal_fault": control.journal.fault,
        "late_ticks": late,
    }


def _measured(control: Control) -> tuple[Output, list[dict[str, Any]]]:
    """Return the output and the gauges; a rig that cannot say them is a rig in FAULT, and the daemon goes on."""
    try:
        gauges = control.rig.gauges()
        return output(gauges), [gauge.plain() for gauge in gauges]
    except Exception as fault:
        if control.machine.state is not State.FAULT:
            control.fault(f"the gauges cannot be read: {reason(fault)}")
        return "unknown", []


def as_bytes(value: Any) -> bytes:
    """Write it as JSON in UTF-8; what is not finite becomes null."""
    return json_text(value).encode()
