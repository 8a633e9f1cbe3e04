"""The table of states, walked through at random beside what the words of docs/service.md say."""

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from rigkit.service.state import ACTIVE, Event, Machine, NotNow, State

PERSON = "Ada", "to see it"


def machine_in(state: State) -> Machine:
    """Return a machine that has come to a state by the shortest way."""
    ways = {
        State.DISARMED: [],
        State.ARMED: [Event.ARM],
        State.CALIBRATING: [Event.ARM, Event.CALIBRATE],
        State.RUNNING: [Event.ARM, Event.RUN],
        State.HOLD: [Event.ARM, Event.RUN, Event.HOLD],
        State.FAULT: [Event.FAULT],
    }
    made = Machine()
    for event in ways[state]:
        made.take(event, *PERSON)
    return made


LEGAL = {
    ("arm", "DISARMED", "ARMED"),
    ("disarm", "ARMED", "DISARMED"),
    ("calibrate", "ARMED", "CALIBRATING"),
    ("run", "ARMED", "RUNNING"),
    ("hold", "RUNNING", "HOLD"),
    ("resume", "HOLD", "RUNNING"),
    ("abort", "CALIBRATING", "CALIBRATING"),
    ("abort", "RUNNING", "RUNNING"),
    ("abort", "HOLD", "HOLD"),
    ("end", "CALIBRATING", "ARMED"),
    ("end", "RUNNING", "ARMED"),
    ("end", "HOLD", "ARMED"),
    ("acknowledge", "FAULT", "DISARMED"),
    *(("fault", state, "FAULT") for state in ("DISARMED", "ARMED", "CALIBRATING", "RUNNING", "HOLD", "FAULT")),
    *(("stop", state, "DISARMED") for state in ("DISARMED", "ARMED", "CALIBRATING", "RUNNING", "HOLD")),
    ("stop", "FAULT", "FAULT"),
}
"""Event, from, to: all there is."""


@pytest.mark.parametrize("event", list(Event))
@pytest.mark.parametrize("state", list(State))
def test_an_event_leads_where_the_page_says_or_is_refused(event: Event, state: State) -> None:
    made = machine_in(state)
    to = [after for name, before, after in LEGAL if (name, before) == (event, state)]
    assert made.allows(event) == bool(to)
    if to:
        assert made.take(event, *PERSON).after == to[0]
    else:
        with pytest.raises(NotNow, match=f"cannot {event} now"):
            made.take(event, *PERSON)
        assert made.state is state


def test_a_machine_is_disarmed_at_first() -> None:
    assert Machine().state is State.DISARMED


@pytest.mark.parametrize(("event", "state"), [(Event.ARM, State.DISARMED), (Event.ACKNOWLEDGE, State.FAULT)])
def test_arming_and_acknowledging_want_a_name_and_a_reason(event: Event, state: State) -> None:
    made = machine_in(state)
    with pytest.raises(ValueError, match="must say why"):
        made.take(event, "Ada", " ")
    with pytest.raises(ValueError, match="must be by a person with a name"):
        made.take(event, "", "to see it")
    assert made.state is state


def test_the_first_fault_keeps_its_reason() -> None:
    made = Machine()
    made.take(Event.FAULT, "run", "the disk is full")
    made.take(Event.FAULT, "run", "and something else")
    made.take(Event.STOP, "Ada", "I am frightened")
    assert (made.state, made.last.why) == (State.FAULT, "the disk is full")


def test_nothing_begins_before_what_was_stopped_has_ended() -> None:
    made = machine_in(State.RUNNING)
    made.take(Event.STOP, *PERSON)
    assert made.ending
    with pytest.raises(NotNow, match="the procedure that was stopped has not ended"):
        made.take(Event.ARM, *PERSON)
    assert made.allowed() == ["stop"]
    made.take(Event.END, *PERSON)
    assert made.state is State.DISARMED
    made.take(Event.ARM, *PERSON)


ENDING = {("end", "DISARMED", "DISARMED"), ("end", "FAULT", "FAULT")}
"""What a procedure that was stopped does when it comes to its end."""


class Walk(RuleBasedStateMachine):
    """Any order of events: the state changes along the table only, and a procedure never runs where nobody armed."""

    def __init__(self) -> None:
        super().__init__()
        self.made, self.armed, self.under_way = Machine(), False, False

    @rule(choice=st.integers(0, 99))
    def onward(self, choice: int) -> None:
        """Take a step that is allowed, and neither a STOP nor a fault: so deep states are reached."""
        allowed = [event for event in Event if self.made.allows(event) and event not in (Event.STOP, Event.FAULT)]
        if allowed:
            self.take(allowed[choice % len(allowed)])

    @rule(event=st.sampled_from(list(Event)))
    def anything(self, event: Event) -> None:
        self.take(event)

    @precondition(lambda self: self.under_way)
    @rule(event=st.sampled_from([Event.STOP, Event.FAULT, Event.END]))
    def what_is_always_allowed_while_a_procedure_is_under_way(self, event: Event) -> None:
        assert self.take(event)

    def take(self, event: Event) -> bool:
        """Take an event if it is allowed, and say whether it was."""
        before, ending = self.made.state, self.under_way and self.made.state not in ACTIVE
        try:
            taken = self.made.take(event, *PERSON)
        except NotNow:
            assert self.made.state is before
            return False
        assert (event, before, taken.after) in LEGAL | (ENDING if ending else set())
        assert not ending or event in (Event.END, Event.FAULT, Event.STOP)
        self.under_way = event in (Event.RUN, Event.CALIBRATE) or (self.under_way and event is not Event.END)
        self.armed = event is Event.ARM or (self.armed and taken.after not in (State.DISARMED, State.FAULT))
        return True

    @invariant()
    def nothing_is_under_way_that_was_not_armed_for(self) -> None:
        assert self.made.busy == self.under_way
        if self.made.state in ACTIVE:
            assert self.armed
            assert self.under_way
        if self.made.state is State.ARMED:
            assert self.armed
            assert not self.under_way


Walk.TestCase.settings = settings(max_examples=100, stateful_step_count=50)
TestWalk = Walk.TestCase
