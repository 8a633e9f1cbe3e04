"""Panels are asked of the rig's process when they have changed, and not for each who watches."""

import asyncio
import json

from rigkit.service.panel_cache import PanelCache
from rigkit.service.slot import Slot


class Asked:
    """A rig's process: it counts what it is asked."""

    def __init__(self) -> None:
        self.slot, self.questions = Slot(), 0
        self.cache = PanelCache(self.slot, self._answer)

    def show(self, **revisions: int) -> None:
        self.slot.put(json.dumps({"panels": revisions}).encode())

    def get(self, name: str, watchers: int = 1) -> set[tuple[int, bytes]]:
        async def all_at_once() -> list[tuple[int, bytes]]:
            return await asyncio.gather(*(self.cache.get(name) for _ in range(watchers)))

        return set(asyncio.run(all_at_once()))

    def _answer(self, name: str) -> tuple[int, bytes]:
        self.questions += 1
        return (200, f"{name} {self.questions}".encode()) if name == "error" else (404, b"none")


def test_a_panel_that_stays_is_asked_for_once_however_many_watch() -> None:
    asked = Asked()
    asked.show(error=1)
    assert asked.get("error", 20) == {(200, b"error 1")}
    assert asked.get("error") == {(200, b"error 1")}


def test_one_that_has_moved_on_is_asked_for_again() -> None:
    asked = Asked()
    asked.show(error=1)
    asked.get("error")
    asked.show(error=2)
    assert asked.get("error", 5) == {(200, b"error 2")}


def test_one_that_there_is_not_is_asked_for_each_time_and_not_kept() -> None:
    asked = Asked()
    assert asked.get("other") == asked.get("other") == {(404, b"none")}
    assert asked.questions == 2
