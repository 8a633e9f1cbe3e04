"""A Dask cluster as the workers of a study: each of its threads has a warm worker process of its own."""

import hashlib
import re
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from tempfile import mkdtemp

from distributed import Client, KilledWorker, Worker, WorkerPlugin, get_worker

from rigkit import atomic
from rigkit.study.crew import Crew
from rigkit.study.outcome import Outcome
from rigkit.study.task import Task

_ADDRESS = re.compile(r"(tcp|tls|ws|wss)://\S+:\d+/?")
_PATIENCE = 10.0
"""s for the scheduler to answer."""
_LOOK = 5.0
"""s between looks at how many workers there are."""
_AHEAD = 2
"""Tasks given to the cluster for each of its threads, so that none waits for the next one."""


class StudyWorker(WorkerPlugin):  # type: ignore[misc]  # typed as Any
    """What every Dask worker has while a study is run: warm processes, and the study's files on its own disk.

    Parameters
    ----------
    files : mapping of str to bytes
    """

    idempotent = False

    def __init__(self, files: Mapping[str, bytes]) -> None:
        self._files = dict(files)
        self.crew: Crew | None = None

    def setup(self, worker: Worker) -> None:
        """Write the files; processes begin with the first tasks."""
        place = Path(mkdtemp(prefix="study-", dir=worker.local_directory))
        files, scratch = place / "files", place / "tasks"
        files.mkdir()
        scratch.mkdir()
        for name, content in self._files.items():
            atomic.write(files / name, content)
        self.crew = Crew(worker.state.nthreads, files, scratch)

    def teardown(self, worker: Worker) -> None:
        """End the processes at once."""
        if self.crew is not None:
            self.crew.end()


class Cluster:
    """The threads of a Dask cluster.

    Parameters
    ----------
    client : Client
    perform : callable(task)
        What a Dask worker calls.
    """

    lost = (KilledWorker,)

    def __init__(self, client: Client, perform: Callable[[Task], Outcome]) -> None:
        self._client, self.perform = client, perform
        self.executor: Executor = client.get_executor(pure=False)
        self._threads, self._looked = 0, -_LOOK

    @property
    def slots(self) -> int:
        """How many tasks are given to the cluster at once: for the workers that it has now, and one to begin with."""
        if time.monotonic() - self._looked > _LOOK:
            self._threads, self._looked = sum(self._client.nthreads().values()), time.monotonic()
        return max(_AHEAD * self._threads, 1)


@contextmanager
def cluster(address: str, files: Path, name: str) -> Iterator[Cluster]:
    """Give the workers of a Dask scheduler; whatever they do for this study ends with the block.

    Parameters
    ----------
    address : str
        Of the scheduler.
    files : Path
        Folder whose files every task finds in its own.
    name : str
        Of the study: two at once on one cluster have different ones.

    Raises
    ------
    ValueError : `address` is none.
    OSError : nothing answers there.
    """
    if not _ADDRESS.fullmatch(address):
        raise ValueError(f"--scheduler is {address!r}, must be such as tcp://lab-7:8786")
    content = {file.name: file.read_bytes() for file in files.iterdir()}
    plugin = f"study-{hashlib.sha256(name.encode()).hexdigest()[:16]}"
    with Client(address, timeout=_PATIENCE, set_as_default=False) as client:
        client.register_plugin(StudyWorker(content), name=plugin)
        made = Cluster(client, partial(_on_worker, plugin))
        try:
            yield made
        finally:
            made.executor.shutdown(wait=False)
            with suppress(OSError, TimeoutError, ValueError):  # the scheduler is gone, and with it its workers
                client.unregister_worker_plugin(plugin)


def _on_worker(plugin: str, task: Task) -> Outcome:
    """Perform a task; called on a Dask worker."""
    crew = get_worker().plugins[plugin].crew
    outcome: Outcome = crew.perform(task)
    return outcome
