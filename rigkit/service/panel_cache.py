"""The panels as the web process has them: each is asked of the rig's process once, however many watch."""

import asyncio
import json
from collections.abc import Callable
from typing import Any

from rigkit.service.slot import Slot


class PanelCache:
    """Answers that hold for as long as the panel's revision does.

    Parameters
    ----------
    slot : Slot
        Snapshots, which say the revisions.
    ask : callable(name) -> (status, bytes)
        Asks the rig's process; it may wait.
    """

    def __init__(self, slot: Slot, ask: Callable[[str], tuple[int, bytes]]) -> None:
        self._slot, self._ask = slot, ask
        self._kept: dict[str, tuple[int, bytes]] = {}
        self._one_question = asyncio.Lock()

    async def get(self, name: str) -> tuple[int, bytes]:
        """Return status and content of an answer."""
        async with self._one_question:
            revision = self._revisions().get(name)
            if revision is None:
                self._kept.pop(name, None)
            elif name in self._kept and self._kept[name][0] == revision:
                return 200, self._kept[name][1]
            status, content = await asyncio.to_thread(self._ask, name)
            if status == 200 and revision is not None:
                self._kept[name] = revision, content
            return status, content

    def _revisions(self) -> dict[str, Any]:
        content = self._slot.get()
        return dict(json.loads(content)["panels"]) if content else {}
