"""The states of a rig under the daemon, and what leads from one to another: no I/O, no clock."""

from dataclasses import dataclass
from enum import StrEnum


class State(StrEnum):
    """Where the rig stands.  It is DISARMED after every start."""

    DISARMED = "DISARMED"
    """Nothing moves, and nothing can be begun."""
    ARMED = "ARMED"
    """Nothing moves; a procedure may be begun."""
    CALIBRATING = "CALIBRATING"
    """A procedure measures the rig."""
    RUNNING = "RUNNING"
    """A procedure runs."""
    HOLD = "HOLD"
    """A procedure waits, and can go on."""
    FAULT = "FAULT"
    """Something is wrong; nothing moves until a person has acknowledged it."""


class Event(StrEnum):
    """What happens to a rig."""

    ARM = "arm"
    DISARM = "disarm"
    CALIBRATE = "calibrate"
    RUN = "run"
    HOLD = "hold"
    RESUME = "resume"
    ABORT = "abort"
    END = "end"
    FAULT = "fault"
    ACKNOWLEDGE = "acknowledge"
    STOP = "stop"


ACTIVE = frozenset({State.CALIBRATING, State.RUNNING, State.HOLD})
"""A procedure is under way."""

_BY_EVENT: dict[Event, dict[State, State]] = {
    Event.ARM: {State.DISARMED: State.ARMED},
    Event.DISARM: {State.ARMED: State.DISARMED},
    Event.CALIBRATE: {State.ARMED: State.CALIBRATING},
    Event.RUN: {State.ARMED: State.RUNNING},
    Event.HOLD: {State.RUNNING: State.HOLD},
    Event.RESUME: {State.HOLD: State.RUNNING},
    Event.ABORT: {state: state for state in ACTIVE},
    Event.END: {
        **dict.fromkeys(ACTIVE, State.ARMED),
        State.DISARMED: State.DISARMED,
        State.FAULT: State.FAULT,
    },
    Event.FAULT: dict.fromkeys(State, State.FAULT),
    Event.ACKNOWLEDGE: {State.FAULT: State.DISARMED},
    Event.STOP: {state: State.FAULT if state is State.FAULT else State.DISARMED for state in State},
}

_BY_PERSON = frozenset(Event) - {Event.END, Event.FAULT}
_WHILE_ENDING = frozenset({Event.END, Event.FAULT, Event.STOP})
"""What may come while a procedure that was stopped has not come to its end."""


class NotNow(ValueError):
    """An event that the present state does not allow; nothing has changed."""


@dataclass(frozen=True)
class Transition:
    """One step from state to state, and whose doing it was."""

    event: Event
    before: State
    after: State
    who: str
    why: str


class Machine:
    """The state, since which step it holds, and whether a procedure has not yet come to its end.

    STOP and a fault take effect at once, while the procedure may need a moment to notice: `busy` until END, and
    until then nothing new is allowed.
    """

    def __init__(self) -> None:
        self.last = Transition(Event.STOP, State.DISARMED, State.DISARMED, "daemon", "started")
        self.busy = False

    @property
    def state(self) -> State:
        """Where the rig stands."""
        return self.last.after

    @property
    def ending(self) -> bool:
        """Whether a procedure was stopped and has not yet come to its end."""
        return self.busy and self.state not in ACTIVE

    def allows(self, event: Event) -> bool:
        """Whether `take` would take it."""
        if (self.ending and event not in _WHILE_ENDING) or (event is Event.END and not self.busy):
            return False
        return self.state in _BY_EVENT[event]

    def allowed(self) -> list[str]:
        """Return what a person may do now."""
        return [event.value for event in Event if event in _BY_PERSON and self.allows(event)]

    def take(self, event: Event, who: str, why: str) -> Transition:
        """Go where `event` leads.

        Parameters
        ----------
        event : Event
        who : str
            A person's name, or the part of the program that did it; not empty.
        why : str
            Not empty for ARM and ACKNOWLEDGE.

        Raises
        ------
        NotNow : the state does not allow it.
        ValueError : nobody is named, or no reason is given where one must be.
        """
        self.check(event, who, why)
        if event in (Event.CALIBRATE, Event.RUN):
            self.busy = True
        elif event is Event.END:
            self.busy = False
        made = Transition(event, self.state, _BY_EVENT[event][self.state], who, why)
        if made.after is not made.before:
            self.last = made
        return made

    def check(self, event: Event, who: str, why: str) -> None:
        """Raise what `take` would raise."""
        if not who.strip():
            raise ValueError(f"{event} by {who!r}, must be by a person with a name")
        if event in (Event.ARM, Event.ACKNOWLEDGE) and not why.strip():
            raise ValueError(f"{event} for the reason {why!r}, must say why")
        if not self.allows(event):
            raise NotNow(f"cannot {event} now: {self._hindrance(event)}")

    def _hindrance(self, event: Event) -> str:
        if self.ending:
            return "the procedure that was stopped has not ended"
        if event is Event.END:
            return "no procedure is under way"
        return f"the rig is {self.state}, must be {' or '.join(state for state in State if state in _BY_EVENT[event])}"
