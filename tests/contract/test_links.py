"""Links of the pages lead to files and headings that are there."""

import re
from functools import cache
from pathlib import Path

import pytest

from tests.contract.source_tree import ROOT

PAGES = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").rglob("*.md")), *sorted((ROOT / "site").glob("*.md"))]
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)
CODE = re.compile(r"^```.*?^```|`[^`\n]*`", re.MULTILINE | re.DOTALL)
GENERATED = "site/"
"""Its pages link to those that `make site` copies and makes, and it refuses a link that leads nowhere."""


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_each_link_leads_somewhere(page: Path) -> None:
    assert [target for target in _inside(page) if not _is_there(page, target)] == []


def test_links_are_found_and_one_that_leads_nowhere_as_well(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("# A heading, `coded`\n[a](page.md#a-heading-coded) [b](gone.md) [c](#gone) [d](https://x.y)\n")
    assert [target for target in _inside(page) if not _is_there(page, target)] == ["gone.md", "#gone"]
    assert sum(len(_inside(each)) for each in PAGES) > 200


def _inside(page: Path) -> list[str]:
    text = CODE.sub("", page.read_text(encoding="utf-8"))
    found = [target for target in LINK.findall(text) if not re.match(r"[a-z]+:", target)]
    return [] if page.is_relative_to(ROOT / GENERATED) else found


def _is_there(page: Path, target: str) -> bool:
    name, _, part = target.partition("#")
    file = (page.parent / name).resolve() if name else page
    return file.exists() and (not part or part in _anchors(file))


@cache
def _anchors(file: Path) -> set[str]:
    """Return the anchors that GitHub and the site give to a page's headings."""
    text = re.sub(r"^```.*?^```", "", file.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    words = (re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", each) for each in HEADING.findall(text))
    return {re.sub(r"[^\w\- ]", "", each.strip().lower()).replace(" ", "-") for each in words}
