"""Control is one person's at a time."""

import pytest

from rigkit.service.lease import Lease, Refused


def test_the_second_who_asks_is_refused_and_told_who_has_it() -> None:
    lease = Lease(30.0)
    lease.take("Ada", 0.0)
    with pytest.raises(Refused, match="Ada has control; Bob may take it over"):
        lease.take("Bob", 1.0)


def test_control_can_be_taken_over_and_the_old_key_is_worth_nothing() -> None:
    lease = Lease(30.0)
    old, from_nobody = lease.take("Ada", 0.0)
    new, whose = lease.take("Bob", 1.0, over=True)
    assert (from_nobody, whose) == ("", "Ada")
    with pytest.raises(Refused, match="Bob has control"):
        lease.use(old.key, 2.0)
    assert lease.use(new.key, 2.0).who == "Bob"


def test_control_that_is_used_lasts_and_control_that_is_not_ends() -> None:
    lease = Lease(30.0)
    key = lease.take("Ada", 0.0)[0].key
    for now in (29.0, 58.0, 87.0):
        lease.use(key, now)
    assert lease.holder(116.9) is not None
    assert lease.holder(117.5) is None
    with pytest.raises(Refused, match="nobody has control"):
        lease.use(key, 117.0)
    assert lease.take("Bob", 117.0)[1] == ""


def test_control_can_be_given_back_by_who_has_it_alone() -> None:
    lease = Lease(30.0)
    key = lease.take("Ada", 0.0)[0].key
    with pytest.raises(Refused):
        lease.give_back("another", 1.0)
    assert lease.give_back(key, 1.0).who == "Ada"
    assert lease.holder(1.0) is None


def test_nobody_without_a_name_gets_control() -> None:
    with pytest.raises(ValueError, match="must be a person's name"):
        Lease(30.0).take(" ", 0.0)
