"""Runs that are killed and taken up again, in processes of their own: `python -m tests.rigkit.killed_run KIND FOLDER`.

A run writes `SHOTS` shots into a folder.  KIND is `steps`, killed at its first system call, then at its second and so
on, or `random`, killed at random moments until it is through.  Prints how many kills there were.
"""

import json
import os
import random
import shutil
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rigkit import atomic
from rigkit.run_folder import CONFIG, SUMMARY, RunFolder, read_events, read_quality

SHOTS = 3
CALLS = ("open", "write", "pwrite", "fsync", "replace", "rename", "ftruncate", "close", "mkdir", "unlink")


def sound(number: int) -> bytes:
    return random.Random(number).randbytes(20_000)


def work(path: Path, reached: Callable[[], None]) -> None:
    folder = RunFolder.open(path) if (path / CONFIG).exists() else RunFolder.create(path, "[rig]\n")
    with folder:
        for number in range(len(read_quality(path)), SHOTS):
            with (
                folder.replacing(f"shots/{folder.shot(number).name}") as temporary,
                temporary.open("wb", buffering=0) as file,
            ):
                file.write(sound(number)[:10_000])
                reached()
                file.write(sound(number)[10_000:])
            folder.quality({"shot": number, "iae": number / 3})
            folder.event("shot", {"number": number})
            folder.summarise({"shots": number + 1})
            reached()


def in_a_child(job: Callable[[], None]) -> int:
    child = os.fork()
    if child == 0:
        try:
            job()
        finally:
            os._exit(0 if sys.exc_info()[0] is None else 1)
    return child


def kill_at(step: int) -> Callable[[], None]:
    """Count system calls; the one numbered `step` is not done, or half done if it writes, and ends the process."""
    count = 0

    def counted(name: str, call: Callable[..., Any]) -> Callable[..., Any]:
        def replacement(*arguments: Any, **options: Any) -> Any:
            nonlocal count
            count += 1
            if count == step:
                if name in ("write", "pwrite"):
                    call(arguments[0], arguments[1][: len(arguments[1]) // 2], *arguments[2:])
                os.kill(os.getpid(), signal.SIGKILL)
            return call(*arguments, **options)

        return replacement

    for name in CALLS:
        setattr(os, name, counted(name, getattr(os, name)))
    return counted("reached", lambda: None)


def check_what_stands(path: Path) -> None:
    """Every file that has its name is whole."""
    for file in (path / "shots").glob("[0-9]*"):
        assert file.read_bytes() == sound(int(file.stem)), file
    assert [row["shot"] for row in read_quality(path)] == [str(number) for number in range(len(read_quality(path)))]
    assert all(event["event"] == "shot" for event in read_events(path))
    if (path / SUMMARY).exists():
        assert 1 <= json.loads((path / SUMMARY).read_text())["shots"] <= SHOTS


def check_the_end(path: Path) -> None:
    check_what_stands(path)
    assert len(read_quality(path)) == SHOTS
    assert len(list((path / "shots").iterdir())) == SHOTS
    assert list(atomic.leftovers(path)) == []
    assert (path / CONFIG).read_text() == "[rig]\n"


def steps(path: Path) -> int:
    for step in range(1, 10_000):
        shutil.rmtree(path, ignore_errors=True)
        _, status = os.waitpid(in_a_child(lambda step=step: work(path, kill_at(step))), 0)
        if not os.WIFSIGNALED(status):
            assert status == 0
            return step - 1
        check_what_stands(path)
        work(path, lambda: None)
        check_the_end(path)
    raise AssertionError("the run has no end")


def at_random(path: Path) -> int:
    chance, kills = random.Random(6), 0
    for _ in range(50):
        shutil.rmtree(path, ignore_errors=True)
        while len(read_quality(path)) < SHOTS:
            told, tell = os.pipe()
            child = in_a_child(lambda tell=tell: work(path, lambda: os.write(tell, b".") and None))
            os.close(tell)
            for _ in range(chance.randint(0, 4)):
                os.read(told, 1)
            for _ in range(chance.randint(0, 10_000)):
                pass  # a random while, too short to sleep
            os.kill(child, signal.SIGKILL)
            kills += os.WIFSIGNALED(os.waitpid(child, 0)[1])
            os.close(told)
            check_what_stands(path)
        work(path, lambda: None)
        check_the_end(path)
    return kills


if __name__ == "__main__":
    os.fsync = os.fstat  # does nothing: a kill does not undo what the kernel has, and some disks take 10 ms to sync
    sys.stdout.write(str({"steps": steps, "random": at_random}[sys.argv[1]](Path(sys.argv[2]))))
