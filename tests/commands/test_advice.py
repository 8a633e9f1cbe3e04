"""Commands that messages, pages and the daemon's page name exist, with the options that are named beside them."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from rigkit.code_name import resolve
from tests.commands.dry_parse import APPLICATIONS, options
from tests.contract.source_tree import PACKAGES, ROOT
from vibrostage.application import PROGRAM as VIBROSTAGE

NAMED = re.compile(rf"(?<![\w./-])({'|'.join(APPLICATIONS)}) ([a-z][a-z-]*)([^`\"\n]*)")
"""A program, a word, and what is beside it to the end of the quoted text or the line."""
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z0-9-]*")
OTHERS = {"--abbrev", "--always", "--dirty", "--exclude"}
"""Options of git, which is called."""
SPAN = re.compile(r"`([^`\n]+)`")
BELOW = {
    "vibrator": "vibractl",
    "stage": "stagectl",
    "cell": "stagectl",
    "calibrate": "calibrate",
    "sim": "firmware-sim",
    "study": "vibrostage study",
}
"""Words of `vibrostage` that are programs."""


def test_the_programs_below_the_umbrella_are_these() -> None:
    assert set(BELOW) == set(VIBROSTAGE.programs)


@pytest.mark.parametrize("package", PACKAGES)
def test_what_a_message_advises_exists(package: str) -> None:
    files = sorted((ROOT / package).rglob("*.py"))
    assert _wrong((file, text) for file in files for text in _texts(file)) == []


def test_what_a_page_names_in_passing_exists() -> None:
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
    assert _wrong((page, span) for page in pages for span in SPAN.findall(page.read_text())) == []


def test_what_the_daemons_page_and_the_units_name_exists() -> None:
    places = [*(ROOT / "rigkit/service/page").iterdir(), *(ROOT / "packaging").rglob("*"), ROOT / "Makefile"]
    files = [each for each in places if each.is_file()]
    assert _wrong((file, line) for file in files for line in file.read_text().splitlines()) == []


def test_a_command_or_an_option_that_does_not_exist_is_found() -> None:
    for text in ("vibractl calibrate", "vibractl run --reume RUN/", "vibractl library ad RUN/", "vibrostage cell run"):
        assert len(_wrong([(Path("x.py"), f"`{text}`")])) == 1
    for text in ("`vibractl run --resume RUN/`", "`vibrostage study run S.toml`", "a `vibractl`", "stagectl and the"):
        assert _wrong([(Path("x.py"), text)]) == []


def _wrong(texts: Iterator[tuple[Path, str]] | list[tuple[Path, str]]) -> list[str]:
    """Return what names a command or an option that is not there; of a sentence, unquoted, what names a command."""
    found = []
    for file, text in texts:
        for match in NAMED.finditer(text):
            program, word, rest = match.groups()
            is_span = text.startswith(program) if file.suffix == ".md" else f"`{program} {word}" in text
            is_meant = is_span or _fault(program, word, "") == ""
            if is_meant and (fault := _fault(program, word, rest)):
                found.append(f"{file}: {match.group(0).strip()}: {fault}")
    return found


def _fault(program: str, word: str, rest: str) -> str:
    if program == "vibrostage" and word in BELOW:
        further = re.match(r" ([a-z][a-z-]*)(.*)", rest)
        if further is None:
            return ""
        if further.group(1) not in resolve(VIBROSTAGE.programs[word]).commands:
            return "no such command"
        return _fault(BELOW[word], further.group(1), further.group(2))
    its = {name: names for name, names in options().items() if f"{name} ".startswith(f"{program} {word} ")}
    if not its:
        return "no such command"
    if f"{program} {word}" not in its:  # one of several
        further = re.match(r" ([a-z][a-z-]*)", rest)
        if further is None:
            return ""
        its = {name: names for name, names in its.items() if name == f"{program} {word} {further.group(1)}"}
        if not its:
            return "no such command"
    known = {option for names in its.values() for option in names} | {"--help"}
    beside = rest.split(f" {program} ")[0]
    absent = [option for option in OPTION.findall(beside) if option not in known]
    return f"no option {absent[0]}" if absent else ""


def _texts(file: Path) -> Iterator[str]:
    """Yield the texts of a module, docstrings as well, a value within one as X."""
    tree = ast.parse(file.read_text())
    within = {id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in node.values}
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            yield "".join(str(each.value) if isinstance(each, ast.Constant) else "X" for each in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in within:
            yield node.value


def test_every_option_that_a_message_names_is_one_of_a_command() -> None:
    known = {option for names in options().values() for option in names} | {"--help", *OTHERS}
    files = [file for package in PACKAGES for file in sorted((ROOT / package).rglob("*.py"))]
    named = {(str(file), option) for file in files for text in _texts(file) for option in OPTION.findall(text)}
    assert {(file, option) for file, option in named if option not in known} == set()
