"""Rows as Parquet, and the hash of a study."""

import random
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest

from rigkit.study.file import Figure
from rigkit.study.results import About, Row, compact, next_file, read_rows, study_hash, write_rows
from tests.rigkit.study.small_study import outcome, plan_of

FIGURES = {
    "total": Figure(file="a.json", path="a", unit="s"),
    "word": Figure(file="a.json", path="b", kind="text"),
    "took": Figure(file="a.json", path="c", timing=True),
}
ABOUT = About("pockets", "to see", FIGURES, {"pocket.json": "abc"})


def rows(folder: Path, count: int = 6) -> list[Row]:
    plan, made = plan_of(folder, count=count), []
    for seed in plan.seeds():
        told = outcome(seed[0], status=2 * (seed[0].seed == 3))
        figures = {"total": np.pi * seed[0].seed, "word": None if seed[0].seed == 2 else "x", "took": 1.0}
        made.append(Row.of(seed[0], replace(told, figures=figures), FIGURES, "feed"))
    return made


def test_rows_are_read_as_they_were_written(tmp_path: Path) -> None:
    made = rows(tmp_path)
    write_rows(tmp_path / "a.parquet", made, ABOUT)
    assert read_rows(tmp_path / "a.parquet") == (ABOUT, made)
    table = pyarrow.parquet.read_table(tmp_path / "a.parquet")
    assert table.schema.field("figure.total").metadata == {b"unit": b"s"}


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="threads are counted in /proc")
def test_reading_begins_no_thread_that_could_abort_a_program_as_it_ends(tmp_path: Path) -> None:
    write_rows(tmp_path / "a.parquet", rows(tmp_path), ABOUT)
    reads = (
        "import os, sys; from pathlib import Path; import pyarrow.parquet; from rigkit.study.results import read_rows\n"
        "before = len(os.listdir('/proc/self/task')); read_rows(Path(sys.argv[1]))\n"
        "print(len(os.listdir('/proc/self/task')) - before)"
    )
    done = subprocess.run(
        [sys.executable, "-c", reads, str(tmp_path / "a.parquet")], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "0"


def test_the_hash_is_that_of_the_figures_whatever_the_order_the_time_and_the_place(tmp_path: Path) -> None:
    made = rows(tmp_path)
    whole = study_hash(made, FIGURES)
    moved = [replace(row, wall=9.0, host="other", tries=3, figures={**row.figures, "took": 7.0}) for row in made]
    random.Random(1).shuffle(moved)
    assert study_hash(moved, FIGURES) == whole
    last = np.nextafter(made[0].figures["total"], 9.0)  # type: ignore[arg-type]  # a number
    assert study_hash([replace(made[0], figures={**made[0].figures, "total": last}), *made[1:]], FIGURES) != whole
    assert study_hash([replace(made[0], status=1), *made[1:]], FIGURES) != whole
    assert study_hash(made[1:], FIGURES) != whole


def test_batches_become_one_file_and_a_task_that_is_there_twice_counts_once(tmp_path: Path) -> None:
    made = rows(tmp_path)
    folder = tmp_path / "results"
    folder.mkdir()
    for batch in (made[3:], made[:3], made[2:4]):
        write_rows(next_file(folder), batch, ABOUT)
    assert [file.name for file in sorted(folder.iterdir())] == [f"00000{n}.parquet" for n in (1, 2, 3)]
    assert read_rows(folder) == (ABOUT, made)
    compact(folder, ABOUT)
    assert [file.name for file in folder.iterdir()] == ["000004.parquet"]
    assert read_rows(folder) == (ABOUT, made)


def test_a_file_of_something_else_is_refused(tmp_path: Path) -> None:
    pyarrow.parquet.write_table(pyarrow.table({"a": [1]}), tmp_path / "x.parquet")
    with pytest.raises(ValueError, match=r"x\.parquet: these are no results of a study"):
        read_rows(tmp_path)
    (tmp_path / "x.parquet").write_bytes(b"PAR1 nothing")
    with pytest.raises(ValueError, match=r"x\.parquet: cannot be read as Parquet"):
        read_rows(tmp_path)
    (tmp_path / "x.parquet").unlink()
    with pytest.raises(ValueError, match="holds no results"):
        read_rows(tmp_path)
    with pytest.raises(FileNotFoundError, match=r"nowhere"):
        read_rows(tmp_path / "nowhere")


def test_results_of_two_studies_are_not_mixed(tmp_path: Path) -> None:
    made = rows(tmp_path)
    write_rows(tmp_path / "a.parquet", made, ABOUT)
    write_rows(tmp_path / "b.parquet", made, replace(ABOUT, name="other"))
    with pytest.raises(ValueError, match=r"b\.parquet: is of another study than a\.parquet"):
        read_rows(tmp_path)
