"""Paths from outside stay within."""

from pathlib import Path

import pytest

from rigkit.service.paths import confined, run_path


@pytest.mark.parametrize(
    "text",
    [
        "../token",
        "a/../../token",
        "/etc/passwd",
        "a//b",
        ".lock",
        "a/.hidden",
        "",
        ".",
        "..",
        "a/",
        "a\0b",
        "..\\token",
    ],
)
def test_what_leads_out_or_is_hidden_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(PermissionError):
        confined(tmp_path, text)


def test_a_link_that_leads_out_is_refused(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    (tmp_path / "token").write_text("secret")
    (tmp_path / "runs" / "innocent").symlink_to(tmp_path / "token")
    (tmp_path / "runs" / "folder").symlink_to(tmp_path)
    for text in ("innocent", "folder/token"):
        with pytest.raises(PermissionError, match="leads out"):
            confined(tmp_path / "runs", text)


def test_what_is_within_is_there(tmp_path: Path) -> None:
    assert confined(tmp_path, "monday/shots/0000.wav") == tmp_path / "monday/shots/0000.wav"


def test_a_run_without_a_name_has_one_of_its_own_at_a_time_that_comes_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("time.strftime", lambda _: "20261025-023000")
    for name in ("20261025-023000", "20261025-023000-2", "20261025-023000-3"):
        path = run_path(str(tmp_path), "")
        assert path == tmp_path / "runs" / name
        path.mkdir(parents=True)
    assert run_path(str(tmp_path), "monday") == tmp_path / "runs" / "monday"
