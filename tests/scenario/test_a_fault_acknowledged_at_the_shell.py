"""After a fault of the stage a person brings it back from the command line, and nothing else does.

Guards against a stage that can only be brought back by switching it off, and against one that starts again by itself.
"""

import sys
from pathlib import Path

import pytest

from firmware_sim.stage_processor import Settings
from stagectl.__main__ import main
from stagectl.link.stage_link import StageLink
from stagectl.wire.messages import State
from tests.stagectl.link.stand_in import SILENT, link_to, running
from tests.until import EVER


@pytest.mark.deadline(SILENT / 2)
def test_a_run_is_refused_until_a_person_has_acknowledged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "adapter"

    def stagectl(*words: str) -> int:
        settings = (f"link.channel={path}", f"link.silence={SILENT}")
        laid_over = [part for text in settings for part in ("--set", text)]
        monkeypatch.setattr(sys, "argv", ["stagectl", *words, *laid_over])
        return main()

    with running(path, Settings(silence=SILENT, ramp=0.02)):
        with StageLink(link_to(path, silence=SILENT)) as link:
            link.start()
            assert not link.wait(10**9, EVER)  # no reference comes for it
        assert stagectl("run", "--live", "--out", str(tmp_path / "run")) == 2
        assert "the stage reports REFERENCE_SILENT; a person must acknowledge" in capsys.readouterr().err
        assert stagectl("acknowledge", "--by", " ") == 2
        assert "must be a person's name" in capsys.readouterr().err
        assert stagectl("acknowledge", "--by", "A. Person") == 0
        assert capsys.readouterr().out == "A. Person has acknowledged: REFERENCE_SILENT\n"
        assert stagectl("acknowledge", "--by", "A. Person") == 2
        assert "is not latched, A. Person has nothing to clear" in capsys.readouterr().err
        with StageLink(link_to(path, silence=SILENT)) as link:
            assert link.state is State.HOLDING
            link.start()
