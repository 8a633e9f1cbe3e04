"""The authority over the rig: who may do what, in which state; one command at a time, STOP at any time."""

import json
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

from pydantic import ValidationError

from rigkit.config import Section
from rigkit.config_fault import ConfigError, explained
from rigkit.service.desk import Board, OpenDesk, Outcome
from rigkit.service.journal import Journal
from rigkit.service.lease import Lease, Refused
from rigkit.service.not_begun import NotBegun, reason
from rigkit.service.rig import Procedure, Rig
from rigkit.service.state import ACTIVE, Event, Machine, NotNow, State
from rigkit.service.stop_log import StopLog
from rigkit.stop import Stopped

DAEMON = "daemon"
"""Who does what no person does."""

Told = dict[str, Any]


class Control:
    """Carries out commands on a rig, holds its state, and runs its procedures.

    Every method may be called from any thread.  `stop` waits for no other command: the output is on its way to zero
    before anything is locked.  Methods with a `key` want the lease of control that it proves; all of them raise
    `Refused`, `NotNow` or a ValueError where they do nothing, and return the state they lead to.

    Parameters
    ----------
    rig : Rig
    lease : Lease
    journal : Journal
    clock : callable() -> float, s, monotonic
    """

    def __init__(self, rig: Rig, lease: Lease, journal: Journal, clock: Callable[[], float] = time.monotonic) -> None:
        self.rig, self.lease, self.journal, self.board = rig, lease, journal, Board()
        self.machine, self.since = Machine(), time.time()
        self._stopping, self._clock = StopLog(journal), clock
        self.desk: OpenDesk | None = None
        """Of the procedure under way."""
        self._newest: OpenDesk | None = None
        self._begins = 0
        self._one_command = threading.Lock()
        self.changing = threading.RLock()
        """Guards machine, lease and desk; never held while the rig works."""
        self._stops = 0
        self._worker: threading.Thread | None = None

    def take_control(self, who: str, over: bool) -> Told:
        """Take the lease; its `key` goes with every command."""
        with self.changing:
            holder, whose = self.lease.take(who, self._clock(), over)
        self.journal.add("control taken over" if whose else "control", holder.who, {"from": whose} if whose else {})
        return {"key": holder.key, "who": holder.who, "seconds": self.lease.seconds}

    def renew(self, key: str) -> Told:
        """Keep the lease for another while."""
        return {"who": self._commander(key), "seconds": self.lease.seconds}

    def give_back(self, key: str) -> Told:
        """End the lease."""
        with self.changing:
            holder = self.lease.give_back(key, self._clock())
        self.journal.add("control given back", holder.who, {})
        return {"who": holder.who}

    def arm(self, key: str, why: str) -> Told:
        """Make the rig ready for procedures."""
        with self._one_command:
            who, stops = self._commander(key), self._stops
            self._check(Event.ARM, who, why)
            self.rig.arm()
            with self.changing:
                if stops == self._stops:
                    return self._take(Event.ARM, who, why)
            self.rig.disarm()
            raise NotNow("cannot arm now: the rig was stopped meanwhile")

    def disarm(self, key: str, why: str) -> Told:
        """Take that back."""
        with self._one_command:
            told = self._take(Event.DISARM, self._commander(key), why)
            self.rig.disarm()
            return told

    def begin(self, key: str, name: str, options: Mapping[str, Any], why: str) -> Told:
        """Begin the procedure `name`, if each option is as it must be."""
        procedure = self._procedure(name)
        chosen = _checked(procedure, options)
        event = Event.CALIBRATE if procedure.kind == "calibrate" else Event.RUN
        with self._one_command:
            edits = self.rig.edits()
            with self.changing:
                who = self._commander(key)
                told = self._take(event, who, why or procedure.title, procedure=name, options=dict(options))
                self.desk = self._newest = OpenDesk(procedure, who, self.board, self.journal)
                self._begins += 1
                self._worker = threading.Thread(target=self._work, args=(self.desk, chosen), name=name, daemon=True)
                if edits:
                    self.desk.event("note", {"text": edits})
                self._worker.start()
                return told | {"number": self._begins}

    def begun(self, number: int) -> Told:
        """Return what came of `begin`, by the `number` that it has returned: while it gets ready, nothing yet."""
        with self.changing:
            desk = self._newest if number == self._begins else None
        return {"outcome": desk.outcome if desk else "begun", "why": desk.why if desk else ""}

    def hold(self, key: str, why: str) -> Told:
        """Let the procedure pause after the step under way."""
        with self._one_command, self.changing:
            who = self._commander(key)
            if self.desk is not None and not self.desk.procedure.pausable:
                raise NotNow(f"cannot hold now: {self.desk.procedure.title} cannot be paused")
            if self.desk is not None and self.desk.ending():
                raise NotNow(f"cannot hold now: {self.desk.procedure.title} is ending")
            told = self._take(Event.HOLD, who, why)
            self._desk().hold(True)
            return told

    def resume(self, key: str, why: str) -> Told:
        """Let it go on."""
        with self._one_command, self.changing:
            told = self._take(Event.RESUME, self._commander(key), why)
            self._desk().hold(False)
            return told

    def abort(self, key: str, why: str) -> Told:
        """Let the procedure end after the step under way; the rig stays armed."""
        with self._one_command, self.changing:
            told = self._take(Event.ABORT, self._commander(key), why)
            self._desk().end()
            return told

    def acknowledge(self, key: str, why: str) -> Told:
        """Leave FAULT in the name of the person who found out why."""
        with self._one_command:
            who = self._commander(key)
            self._check(Event.ACKNOWLEDGE, who, why)
            self.rig.acknowledge(who)
            return self._take(Event.ACKNOWLEDGE, who, why)

    def reload(self, key: str) -> Told:
        """Read the rig file again."""
        return self.reload_for(self._commander(key))

    def reload_for(self, who: str) -> Told:
        """Read it again for somebody who needs no lease: whoever may send the process a signal."""
        with self._one_command:
            change = self.rig.reload()
        told = {"reach": change.reach.name.lower(), "keys": sorted(change.keys), "done": change.done}
        self.journal.add("reload", who, told)
        return told

    def inject(self, key: str, sensor: str, kind: str) -> Told:
        """Put a fault into a sensor on purpose, or take it away by "none"; whatever the state."""
        who, faults = self._commander(key), self.rig.faults
        if faults is None:
            raise Refused("faults on purpose are not allowed: daemon.faults is false")
        faults.inject(sensor, kind)
        self.journal.add("fault on purpose", who, {"sensor": sensor, "kind": kind})
        return {"faults": faults.present()}

    def stop(self, who: str, why: str, asker: str = "") -> Told:
        """Bring the output to zero and disarm: for anybody, with or without the lease, whatever goes on.

        Parameters
        ----------
        who, why : str
        asker : str
            By what repeats are known in the event log; `who` if empty.
        """
        self.rig.stop()
        told, before = self._halt(Event.STOP, who, why, asker)
        if before is State.ARMED:
            with self._one_command:
                if self.machine.state is State.DISARMED:
                    self.rig.disarm()
        return told

    def fault(self, why: str, who: str = DAEMON) -> Told:
        """Bring the output to zero: something is wrong."""
        self.rig.stop()
        return self._halt(Event.FAULT, who, why)[0]

    def settle(self) -> None:
        """Stop the output once more while a procedure that must end has not: it may just have begun a step."""
        if self.machine.ending:
            self.rig.stop()
        with self.changing:
            self._stopping.settle(self._clock())

    def close(self, seconds: float) -> None:
        """Stop, wait up to `seconds` for the procedure to end, and give up the rig."""
        self.stop(DAEMON, "the daemon ends")
        if self._worker is not None:
            self._worker.join(seconds)
        self.rig.close()
        with self.changing:
            self._stopping.end()

    def _halt(self, event: Event, who: str, why: str, asker: str = "") -> tuple[Told, State]:
        with self.changing:
            self._stops += 1
            before = self.machine.state
            told = self._take(event, who, why, asker)
            if self.desk is not None:
                self.desk.end()
        self.rig.stop()
        return told, before

    def _work(self, desk: OpenDesk, options: Section) -> None:
        """Run a procedure, in its own thread."""
        why, refusal = f"{desk.procedure.title} has ended", ""
        outcome: Outcome = "begun"
        try:
            desk.procedure.run(desk, options)
        except Stopped as end:
            why = str(end)
        except NotBegun as refused:
            why, outcome, refusal = f"{desk.procedure.title} has not begun: {refused}", "not begun", str(refused)
        except Exception as fault:
            outcome, refusal = "failed", reason(fault)
            self.fault(refusal, desk.procedure.name)
        with self.changing:
            armed = self.machine.state in ACTIVE
            if armed:
                self._ended(desk, why)
        if not armed:  # and cannot be, before the end is told
            with self._one_command:
                self.rig.disarm()
            self._ended(desk, why)
        desk.end_as(outcome, refusal)

    def _ended(self, desk: OpenDesk, why: str) -> None:
        with self.changing:
            self.desk = None
            self._take(Event.END, desk.procedure.name, why)

    def _desk(self) -> OpenDesk:
        if self.desk is None:
            raise NotNow("cannot do that now: the procedure has just ended")
        return self.desk

    def _commander(self, key: str) -> str:
        with self.changing:
            return self.lease.use(key, self._clock()).who

    def _check(self, event: Event, who: str, why: str) -> None:
        with self.changing:
            self.machine.check(event, who, why)

    def _take(self, event: Event, who: str, why: str, asker: str = "", **fields: Any) -> Told:
        with self.changing:
            made = self.machine.take(event, who, why)
            told = {"state": made.after.value, "before": made.before.value, "why": why}
            if made.after is not made.before:
                self.since = time.time()
                self._stopping.end()
            if event is Event.STOP:
                self._stopping.add(asker or who, who, told, self._clock())
            else:
                self.journal.add(event.value, who, told | fields)
        return told

    def _procedure(self, name: str) -> Procedure:
        there = {procedure.name: procedure for procedure in self.rig.procedures}
        if name not in there:
            raise LookupError(f"there is no procedure {name!r}; there are {', '.join(there)}")
        return there[name]


def _checked(procedure: Procedure, options: Mapping[str, Any]) -> Section:
    try:
        return procedure.options.model_validate_json(json.dumps(options))
    except ValidationError as fault:
        raise ConfigError(explained(fault, procedure.options, options, procedure.name)[1]) from None
