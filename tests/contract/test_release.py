"""What a release is made of says the same version: the changelog, the citation, the fallback of the build."""

import re
import tomllib

from tests.contract.source_tree import PACKAGES, ROOT

VERSION = re.compile(r"(\d+)\.(\d+)\.(\d+)")
FALLBACK: str = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools_scm"]["fallback_version"]


def test_the_changelog_is_by_version_the_newest_first() -> None:
    heads = re.findall(r"^## (.*)$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert heads[0] == "[Unreleased]"
    dated = [re.fullmatch(r"\[(\d+\.\d+\.\d+)\] - \d{4}-\d{2}-\d{2}", head) for head in heads[1:]]
    assert None not in dated, heads
    versions = [tuple(map(int, each.group(1).split("."))) for each in dated if each is not None]
    assert versions == sorted(set(versions), reverse=True)
    if versions:
        assert FALLBACK == ".".join(map(str, versions[0]))


def test_the_citation_and_the_image_have_the_version_of_files_without_a_history() -> None:
    assert VERSION.fullmatch(FALLBACK)
    assert f"version: {FALLBACK}\n" in (ROOT / "CITATION.cff").read_text()
    assert f"ARG VERSION={FALLBACK}\n" in (ROOT / "Dockerfile").read_text()


def test_the_image_is_made_of_files_that_are_there_runs_a_program_and_is_not_root() -> None:
    """No Docker runs here: the lines are read."""
    text = (ROOT / "Dockerfile").read_text()
    copied = [name for line in re.findall(r"^COPY (?!--)(.*)$", text, re.MULTILINE) for name in line.split()[:-1]]
    assert {*PACKAGES, "pyproject.toml", "MANIFEST.in", "LICENSE", "README.md"} <= set(copied)
    assert [name for name in copied if not (ROOT / name).exists()] == []
    let_in = {line[1:] for line in (ROOT / ".dockerignore").read_text().splitlines() if line.startswith("!")}
    assert set(copied) <= let_in
    *_, user = re.findall(r"^USER (.*)$", text, re.MULTILINE)
    assert user not in ("root", "0")
    (entry,) = re.findall(r'^ENTRYPOINT \["(.*)"\]$', text, re.MULTILINE)
    assert entry in tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
