"""The tables of docs/populations.md, from results of studies that are kept in docs/populations/.

`python -m benchmarks.study_tables [FOLDER ...]` takes in the results of studies that have ended, such as
runs/studies/stages, and writes the page again; without a folder it writes the page alone.
"""

import sys
from pathlib import Path

from benchmarks.page_table import DOCS
from rigkit.origin import checksum
from rigkit.report import Table
from rigkit.study.report import StudyReport
from rigkit.study.results import write_rows
from rigkit.study.tables import endings_table, markdown

KEPT = DOCS / "populations"
PAGE = DOCS / "populations.md"
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


def page() -> str:
    """Return the page that belongs to the kept results."""
    return "\n".join([_HEAD, *(section(file) for file in sorted(KEPT.glob("*.parquet")))])


def section(file: Path) -> str:
    """Return the part of one study, with the sum of the file that it belongs to."""
    found = StudyReport.of(file)
    told = found.told()
    seeds = [row.seed for row in found.rows]
    origin = (
        f"`studies/{file.stem}.toml`, seeds {min(seeds)} to {max(seeds)}, {told['cpu_hours']:.2f} h of processor time, "
        f"{told['finished'][:10]}; {'; '.join([*told['software'], *told['processors']])}; "
        f"study hash `{told['hash'][:16]}`; `docs/populations/{file.name}`, SHA-256 `{checksum(file)[:16]}`."
    )
    tables = [f"**{text}**\n\n{markdown(table)}\n" for text, table in found.tables()]
    if ends := endings_table(found.rows).rows[:MOST_ENDS]:
        rows = tuple((text, count, name) for text, _, count, name, _ in ends)
        tables.append(f"**not done**\n\n{markdown(Table(('last line', 'tasks', 'the first'), rows))}\n")
    return "\n".join([f"## {file.stem}\n", f"{found.about.purpose}\n", *tables, f"{origin}\n"])


def take_in(folder: Path) -> None:
    """Keep the results of a study, in one file."""
    found = StudyReport.of(folder)
    KEPT.mkdir(exist_ok=True)
    write_rows(KEPT / f"{folder.name}.parquet", found.rows, found.about)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        take_in(Path(name))
    PAGE.write_text(page(), encoding="utf-8")
    print(f"{PAGE}: {len(list(KEPT.glob('*.parquet')))} studies")
