"""Small faults put into the code on purpose, one at a time: each should fail a test.  `python -m benchmarks.mutants`.

A fixed random sample of all that cosmic-ray's operators can do to the modules below, drawn anew the same each time by
`SEED`.  They are put into a copy of the checkout, in build/mutants, and tried against the tests of their module.
Results stand in build/mutants.json as they come: stopped, the same command goes on.  Left out: changes of texts, which
the operators do not make, and of `|`, which stands in types.
"""

import hashlib
import json
import os
import shutil
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import typer
from cosmic_ray import plugins
from cosmic_ray.ast import ast_nodes, get_ast_from_path
from cosmic_ray.mutating import use_mutation

ROOT = Path(__file__).parents[1]
COPY, RESULTS = ROOT / "build" / "mutants", ROOT / "build" / "mutants.json"
SEED = 20
LEFT_OUT = ("BitOr", "NoOp", "no-op")
LONGEST = 20.0, 5.0
"""s, and times what the tests take without a fault, after which one that hangs is killed."""
SERVICE, WIRE = "tests/rigkit/service", "tests/stagectl/wire"
TESTS = {
    "vibractl/guard.py": "tests/vibractl/test_guard.py",
    "vibractl/guard_kernel.py": "tests/vibractl/test_guard.py",
    "vibractl/learning/law.py": "tests/vibractl/learning/test_law.py",
    "vibractl/learning/line_filter.py": "tests/vibractl/learning/test_line_filter.py",
    "vibractl/learning/watch.py": "tests/vibractl/learning/test_watch.py",
    "vibractl/learning/rollback.py": "tests/vibractl/learning/test_rollback.py",
    "vibractl/session.py": " ".join(
        f"tests/vibractl/test_{name}.py" for name in ("session", "command_line", "run_origin", "faults_on_purpose")
    ),
    "rigkit/service/control.py": f"{SERVICE}/test_control.py",
    "rigkit/service/lease.py": f"{SERVICE}/test_lease.py",
    "rigkit/service/access.py": f"{SERVICE}/test_access.py",
    "rigkit/service/gate.py": f"{SERVICE}/test_gate.py {SERVICE}/test_gate_crowd.py",
    "rigkit/relay/frame.py": "tests/rigkit/relay",
    "rigkit/wire/layout.py": f"{WIRE}/test_layout.py",
    "stagectl/wire/samples.py": f"{WIRE}/test_samples.py",
    "stagectl/wire/sequence.py": f"{WIRE}/test_sequence.py",
}
"""What is tried, and the tests that should fail."""


@dataclass(frozen=True)
class Mutant:
    """One fault: the operator's occurrence in a file, and where that is."""

    file: str
    operator: str
    occurrence: int
    line: int

    @property
    def key(self) -> str:
        return f"{self.file} {self.operator.removeprefix('core/')} {self.occurrence}"

    @property
    def name(self) -> str:
        return f"{self.file}:{self.line} {self.operator.removeprefix('core/')} {self.occurrence}"

    @property
    def lot(self) -> str:
        """By which it is drawn: code that is changed elsewhere draws no other ones."""
        return hashlib.sha256(f"{SEED} {self.key}".encode()).hexdigest()


def mutants(file: str) -> list[Mutant]:
    """Return all that can be put into a file."""
    found = []
    tree = get_ast_from_path(ROOT / file)
    for name in sorted(plugins.operator_names()):
        operator = plugins.get_operator(name)
        if operator.arguments() or any(part in name for part in LEFT_OUT):
            continue
        places = [start for node in ast_nodes(tree) for start, _ in operator().mutation_positions(node)]
        found += [Mutant(file, name, number, line) for number, (line, _) in enumerate(places)]
    return found


def sample(count: int) -> list[Mutant]:
    """Return the sample; a smaller one is the beginning of a larger one."""
    every = [mutant for file in TESTS for mutant in mutants(file)]
    return sorted(every, key=lambda mutant: mutant.lot)[:count]


def copied() -> None:
    """Copy what git has of the checkout, as it is now."""
    shutil.rmtree(COPY, ignore_errors=True)
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in listed.splitlines():
        if (ROOT / name).is_file():
            (COPY / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, COPY / name)


def tested(file: str, seconds: float) -> tuple[str, float]:
    """Run the tests of a file in the copy; return what came of it, and how long it took, s."""
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-x",
        "-m",
        "not slow",
        "-p",
        "no:cacheprovider",
        *TESTS[file].split(),
    ]
    apart = {"NUMBA_CACHE_DIR": str(COPY / "cache" / Path(file).stem), "PYTHONPATH": str(COPY)}
    begin = time.monotonic()
    try:
        done = subprocess.run(
            command, cwd=COPY, env=os.environ | apart, capture_output=True, timeout=seconds, check=False
        )
    except subprocess.TimeoutExpired:
        return "timeout", seconds
    return ("survived" if done.returncode == 0 else "killed"), time.monotonic() - begin


def tried(mutant: Mutant, seconds: float) -> str:
    """Put one in, run the tests, take it out again."""
    operator = plugins.get_operator(mutant.operator)()
    with use_mutation(COPY / mutant.file, operator, mutant.occurrence):
        return tested(mutant.file, seconds)[0]


def main(count: int = 300) -> None:
    """Try the sample and print what survives; exit with 1 where docs/mutants.md does not explain all of that."""
    chosen = sample(count)
    known: dict[str, str] = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    copied()
    undisturbed: dict[str, float] = {}
    for number, mutant in enumerate(chosen, start=1):
        if mutant.key in known:
            continue
        if mutant.file not in undisturbed:
            outcome, took = tested(mutant.file, 600.0)
            assert outcome == "survived", f"{TESTS[mutant.file]} fails without a fault"
            undisturbed[mutant.file] = LONGEST[0] + LONGEST[1] * took
        known[mutant.key] = tried(mutant, undisturbed[mutant.file])
        RESULTS.write_text(json.dumps(known, indent=1))
        print(f"{number} of {count}: {known[mutant.key]}: {mutant.name}", flush=True)
    report(chosen, known)


def report(chosen: list[Mutant], known: dict[str, str]) -> None:
    """Print how many of each there are, and those that survived."""
    print(dict(Counter(known[mutant.key] for mutant in chosen)))
    page = ROOT / "docs" / "mutants.md"
    explained = page.read_text() if page.exists() else ""
    survived = [mutant for mutant in chosen if known[mutant.key] == "survived"]
    for mutant in survived:
        print(f"survived{', explained' if mutant.key in explained else ''}: {mutant.name}")
    sys.exit(any(mutant.key not in explained for mutant in survived))


if __name__ == "__main__":
    typer.run(main)
