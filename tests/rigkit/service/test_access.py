"""Who may reach the daemon, under which names, with which token."""

from pathlib import Path
from typing import Any

import pytest

from rigkit.service.access import address_of, names, new_tokens, origins, read_tokens, refuse_open, tokens_at
from rigkit.service.config import Daemon


@pytest.mark.parametrize("address", ["127.0.0.1:8787", "localhost:1", "[::1]:8787", "127.9.9.9:80", "unix:/run/x.sock"])
def test_this_machine_may(address: str) -> None:
    refuse_open(Daemon(address=address))


@pytest.mark.parametrize("address", ["0.0.0.0:8787", "[::]:8787", "192.168.1.5:8787", "lab-pc:8787", "[fe80::1]:80"])
def test_others_may_with_tls_or_by_a_word_of_the_rig_file_alone(address: str) -> None:
    with pytest.raises(ValueError, match="which other machines reach: give daemon.certificate"):
        refuse_open(Daemon(address=address))
    refuse_open(Daemon(address=address, certificate="a.pem", key="b.pem"))
    refuse_open(Daemon(address=address, plain=True))


def test_a_certificate_without_its_key_is_refused() -> None:
    with pytest.raises(ValueError, match="go together"):
        refuse_open(Daemon(certificate="a.pem"))


@pytest.mark.parametrize(
    ("settings", "there", "not_there"),
    [
        ({}, {"127.0.0.1:8787", "localhost:8787", "[::1]:8787"}, {"localhost", "127.0.0.1:80"}),
        ({"address": "127.0.0.1:80"}, {"localhost", "localhost:80"}, {"localhost:8787"}),
        ({"address": "0.0.0.0:8787", "hosts": ("lab-pc:8787",)}, {"lab-pc:8787"}, {"0.0.0.0:8787"}),
        ({"address": "10.0.0.5:8787"}, {"10.0.0.5:8787"}, {"10.0.0.6:8787"}),
        ({"address": "[fd00::5]:8787"}, {"[fd00::5]:8787"}, {"fd00::5:8787"}),
        ({"address": "unix:/run/x"}, {"localhost"}, {"127.0.0.1"}),
    ],
)
def test_the_names_are_the_address_and_those_given(
    settings: dict[str, Any], there: set[str], not_there: set[str]
) -> None:
    found = names(Daemon(**settings))
    assert there <= found
    assert not not_there & found


def test_a_page_comes_from_one_of_the_names_by_the_scheme_that_is_served() -> None:
    assert "http://localhost:8787" in origins(Daemon())
    assert "https://localhost:8787" in origins(Daemon(certificate="a", key="b"))
    assert "http://localhost:8787" not in origins(Daemon(certificate="a", key="b"))


def test_an_address_is_read() -> None:
    assert (address_of("[::1]:80").host, address_of("[::1]:80").port) == ("::1", 80)
    assert address_of("unix:/run/x").path == "/run/x"


def test_tokens_are_made_once_for_their_owner_alone_and_give_the_role(tmp_path: Path) -> None:
    made = tokens_at(tmp_path / "token")
    assert (tmp_path / "token").stat().st_mode & 0o777 == 0o600
    assert tokens_at(tmp_path / "token") == made
    assert [made.role(token) for token in (made.view, made.operate, "", "x", made.view[:-1])] == [
        "view",
        "operate",
        None,
        None,
        None,
    ]
    assert made.role("é\udcff".encode(errors="surrogateescape").decode("latin-1")) is None


def test_new_tokens_put_an_end_to_the_old(tmp_path: Path) -> None:
    old = tokens_at(tmp_path / "token")
    new = new_tokens(tmp_path / "token")
    assert tokens_at(tmp_path / "token") == new
    assert new.role(old.operate) is None


@pytest.mark.parametrize(
    ("content", "mode", "text"),
    [
        ('view = "{a}"\noperate = "{b}"\n', 0o640, "can be read by others, mode 640"),
        ('view = "{a}"\n', 0o600, "does not hold the tokens"),
        ("nothing", 0o600, "does not hold the tokens"),
        ('view = ""\noperate = "{b}"\n', 0o600, "alike or shorter"),
        ('view = "{a}"\noperate = "{a}"\n', 0o600, "alike or shorter"),
    ],
)
def test_a_file_of_tokens_that_is_not_safe_is_refused(tmp_path: Path, content: str, mode: int, text: str) -> None:
    path = tmp_path / "token"
    path.write_text(content.format(a="a" * 40, b="b" * 40))
    path.chmod(mode)
    with pytest.raises(ValueError, match=text):
        read_tokens(path)
