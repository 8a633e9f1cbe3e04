"""Pages of the site that are copied or made: those of docs/, the change log, decisions, commands."""

import re
import shutil
from pathlib import Path

import typer
from typer.cli import get_docs_for_click
from typer.main import get_command

from rigkit.code_name import resolve

PROGRAMS = {
    "vibractl": "vibractl.application:PROGRAM",
    "stagectl": "stagectl.application:PROGRAM",
    "calibrate": "calibration.application:PROGRAM",
    "firmware-sim": "firmware_sim.application:PROGRAM",
    "vibrostage": "vibrostage.application:PROGRAM",
    "vibrostage study": "vibrostage.application:STUDY",
}
_LINK = re.compile(r"(!?\[[^\]]*\]\()([^)\s#]+)(#[^)\s]*)?\)")


def write(site: Path, root: Path) -> None:
    """Write all of them below `site`.

    Parameters
    ----------
    site : Path
        The folder of the site's sources.
    root : Path
        Of the checkout.
    """
    guide = site / "guide"
    shutil.rmtree(guide, ignore_errors=True)
    shutil.copytree(root / "docs", guide)
    for name in ("CHANGELOG.md", "CONTRIBUTING.md"):
        shutil.copy(root / name, guide / name.lower())
    for page in guide.rglob("*.md"):
        page.write_text(_linked(page.read_text(encoding="utf-8"), page, guide, root), encoding="utf-8")
    _index(guide)
    commands = site / "commands"
    shutil.rmtree(commands, ignore_errors=True)
    commands.mkdir()
    for name, place in PROGRAMS.items():
        (commands / f"{name.replace(' ', '-')}.md").write_text(_program(name, place), encoding="utf-8")


def _linked(text: str, page: Path, guide: Path, root: Path) -> str:
    """Return a page whose links to what is no page of the site are its words alone."""
    here = root / "docs" / page.relative_to(guide)
    if page.name in ("changelog.md", "contributing.md"):
        here = root / page.name

    def link(found: re.Match[str]) -> str:
        head, target, part = found[1], found[2], found[3] or ""
        if re.match(r"[a-z]+:", target):
            return found[0]
        place = (here.parent / target).resolve()
        if place.is_relative_to(root / "docs") and place.is_file():
            inside = guide / place.relative_to(root / "docs")
        elif place.name in ("CHANGELOG.md", "CONTRIBUTING.md") and place.parent == root:
            inside = guide / place.name.lower()
        elif place.name == "README.md" and place.parent == root:
            inside = guide.parent / "index.md"
        elif place.exists():
            return head.removeprefix("[").removesuffix("](")
        else:
            return found[0]
        return f"{head}{_relative(inside, page.parent)}{part})"

    return _LINK.sub(link, text)


def _relative(target: Path, start: Path) -> str:
    up, common = 0, start
    while not target.is_relative_to(common):
        common, up = common.parent, up + 1
    return "../" * up + target.relative_to(common).as_posix()


def _index(guide: Path) -> None:
    decisions = sorted((guide / "decisions").glob("*.md"))
    rows = "\n".join(f"decisions/{each.stem}" for each in decisions)
    (guide / "decisions.md").write_text(
        f"# Decisions\n\nDesign decisions and their reasons, a page each.\n\n```{{toctree}}\n{rows}\n```\n",
        encoding="utf-8",
    )


def _program(name: str, place: str) -> str:
    """Return a page of a program's commands, as they say it themselves."""
    group = get_command(resolve(place).only())
    return str(get_docs_for_click(obj=group, ctx=typer.Context(group, info_name=name), name=name))
