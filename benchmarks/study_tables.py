"""The tables of docs/ that studies have given, from their results, which are kept in docs/populations/.

`python -m benchmarks.study_tables [FOLDER ...]` takes in the results of studies that have ended, such as
runs/studies/stages, and writes the pages again; without a folder it writes the pages alone.  Studies of drawn machines
have docs/populations.md to themselves; each of the others stands in the page of what it is about.
"""

import sys
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from benchmarks.ablation import ablation_table, shot
from benchmarks.feed_study import feed_force_table
from benchmarks.milling_study import milling_table, soft_table
from benchmarks.page_table import DOCS, replaced
from rigkit.origin import checksum
from rigkit.report import Table
from rigkit.study.report import StudyReport
from rigkit.study.results import Row, write_rows
from rigkit.study.summary import share_of
from rigkit.study.tables import endings_table, markdown

KEPT = DOCS / "populations"
STUDIES = DOCS.parent / "studies"
PAGE = DOCS / "populations.md"
PLACES = {
    "ablation": "validation/learning.md",
    "around": "validation/vibrator-studies.md",
    "feed-force": "validation/force.md",
    "learning": "validation/learning.md",
    "milling": "validation/milling.md",
    "milling-deep": "validation/milling.md",
    "milling-soft": "validation/milling.md",
    "prediction": "validation/vibrator-studies.md",
    "quiet": "validation/vibrator-studies.md",
    "soft-start": "validation/vibrator-studies.md",
    "warm-start": "validation/vibrator-studies.md",
    "watch": "validation/vibrator-studies.md",
}
"""The page of each study that is not of drawn machines; between marks of the study's name."""
NEAR = 3
"""Shots by which a prediction may be off."""
MOST_ENDS = 5
LARGEST = 2_000_000
"""Bytes of all kept results together."""
_HEAD = """\
# Populations: what studies have found

Each table is of machines that were drawn by seed, and known to no controller. Seeds are taken in order until two hours
of processor time are spent, or as far as the line under the tables says; N is how many tasks that makes. What was
refused or failed does not pass, and counts in N.  The intervals are Wilson's, 95 %. Written by `make studies`
([studies](studies.md)) from the results in `docs/populations/`; `make studies STUDIES=NAME` runs one again.
"""


def pages() -> dict[Path, str]:
    """Return the text of every page, as it belongs to the kept results."""
    kept = sorted(KEPT.glob("*.parquet"))
    texts = {PAGE: "\n".join([_HEAD, *(section(file) for file in kept if file.stem not in PLACES)])}
    for file in kept:
        if file.stem in PLACES:
            page = DOCS / PLACES[file.stem]
            text = texts.get(page) or page.read_text(encoding="utf-8")
            texts[page] = replaced(text, file.stem, tables(file, report_of(file)))
    return texts


def report_of(file: Path) -> StudyReport:
    """Return kept results under the titles that `studies/NAME.toml` has now; results hold those of their own time."""
    found, study = StudyReport.of(file), STUDIES / f"{file.stem}.toml"
    if not study.is_file():
        return found
    tables = tomllib.loads(study.read_text(encoding="utf-8"))["figures"]
    titles = {name: tables.get(name, {}).get("title", figure.title) for name, figure in found.about.figures.items()}
    figures = {name: each.model_copy(update={"title": titles[name]}) for name, each in found.about.figures.items()}
    return replace(found, about=replace(found.about, figures=figures))


def section(file: Path) -> str:
    """Return the part of one study of drawn machines."""
    found = report_of(file)
    return f"## {file.stem}\n\n{found.about.purpose}\n\n{tables(file, found)}"


def tables(file: Path, found: StudyReport) -> str:
    """Return the tables of one study, with the sum of the file that they belong to."""
    told = found.told()
    seeds = [row.seed for row in found.rows]
    origin = (
        f"`studies/{file.stem}.toml`, seeds {min(seeds)} to {max(seeds)}, {told['cpu_hours']:.2f} h of processor time, "
        f"{told['finished'][:10]}; {'; '.join([*told['software'], *told['processors']])}; "
        f"study hash `{told['hash'][:16]}`; `docs/populations/{file.name}`, SHA-256 `{checksum(file)[:16]}`."
    )
    if file.stem in INSTEAD:
        texts = [f"{INSTEAD[file.stem](found)}\n"]
    else:
        texts = [f"**{text}**\n\n{markdown(table)}\n" for text, table in found.tables()]
    if ends := endings_table(found.rows).rows[:MOST_ENDS]:
        rows = tuple((text, count, name) for text, _, count, name, _ in ends)
        texts.append(f"**not done**\n\n{markdown(Table(('last line', 'tasks', 'the first'), rows))}\n")
    if file.stem in BESIDE:
        texts.append(f"{BESIDE[file.stem](found.rows)}\n")
    return "\n".join([*texts, f"{origin}\n"])


def predicted_beside_observed(rows: Sequence[Row]) -> str:
    """Say of each law how often a prediction was right, shots beyond the run counted as one."""
    said = []
    for law in dict.fromkeys(row.case["learning.law"] for row in rows):
        told = [_shots(row) for row in rows if row.case["learning.law"] == law and not row.status]
        near = sum(middle == observed or abs(middle - observed) <= NEAR for _, middle, _, observed in told)
        within = sum(low <= observed <= high for low, _, high, observed in told)
        said.append(
            f"- `{law}`: the median is within {NEAR} shots of what was observed on {near} of {len(told)}, and what was "
            f"observed within 10 to 90 % of what was predicted on {within}."
        )
    return "\n".join(said)


def _shots(row: Row) -> tuple[float, ...]:
    names = ("low", "predicted", "high", "observed")
    return tuple(shot(row.figures[name]) for name in names)


EARLY = 14
"""Shot by which the objective is wanted."""


def within_the_floor(rows: Sequence[Row]) -> str:
    """Say how many machines that do not move by more than the limit are learned, by both laws, and which are not."""
    ended = [row for row in rows if not row.status]
    able = [row for row in ended if row.figures["floor"] is None or float(row.figures["floor"]) <= 0]
    held = [row for row in able if row.figures["shot"] is not None]
    early = [row for row in held if float(row.figures["shot"]) <= EARLY]
    by_thesis = [row for row in able if row.figures["thesis"] is not None]
    lost = [f"{row.seed}-{row.case['reference']} ({row.figures['worst']:+.1f} dB)" for row in able if row not in held]
    shares = [share_of(len(each), len(able)) for each in (held, early, by_thesis)]
    met, soon, thesis = (f"{each.text} ({each.interval})" for each in shares)
    others = len(ended) - len(able)
    return (
        f"Of {len(ended)} that ran to the end, {len(able)} move by no more than the limit from shot to shot by "
        f"themselves, as the program says. Of those {met} meet the objective and hold it to shot 60, {soon} from shot "
        f"{EARLY} or sooner; by the thesis' law {thesis}. Not met, with the worst bin at shot 60: "
        f"{', '.join(lost) or 'none'}. Of the {others} others "
        f"{sum(row.figures['shot'] is not None for row in ended if row not in able)} are met."
    )


BESIDE: dict[str, Callable[[Sequence[Row]], str]] = {
    "prediction": predicted_beside_observed,
    "vibrators": within_the_floor,
}
"""What else is said of a study."""
INSTEAD: dict[str, Callable[[StudyReport], str]] = {
    "ablation": ablation_table,
    "feed-force": feed_force_table,
    "milling": milling_table,
    "milling-deep": milling_table,
    "milling-soft": soft_table,
}
"""What is shown in place of a table for each figure."""


def take_in(folder: Path) -> None:
    """Keep the results of a study, in one file."""
    found = StudyReport.of(folder)
    KEPT.mkdir(exist_ok=True)
    write_rows(KEPT / f"{folder.name}.parquet", found.rows, found.about)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        take_in(Path(name))
    for page, text in pages().items():
        page.write_text(text, encoding="utf-8")
    print(f"{KEPT}: {len(list(KEPT.glob('*.parquet')))} studies")
