"""Where batches are solved: in this process, on all cores, or on a Dask cluster that is there."""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from typing import Any, NamedTuple, TypeVar

from limbik.core.errors import EnvironmentProblem, LimbikError
from limbik.plugins.experiments import guard
from limbik.plugins.experiments.batch import Job, Part, run_batch
from limbik.plugins.experiments.folder import Folder
from limbik.plugins.experiments.identity import versions
from limbik.plugins.experiments.model import DASK, LOCAL, SERIAL
from limbik.plugins.experiments.plan import Batch

CONNECT = 5.0  # seconds a scheduler has to answer
Found = TypeVar("Found")


class WorkerLost(Exception):
    """A worker process was ended from outside; what it had not finished can be done again."""


class Done(NamedTuple):
    """A batch whose part is kept, and how many of its solves failed."""

    batch: Batch
    failed: int


def run_jobs(
    engine: str,
    jobs: Iterable[Job],
    folder: Folder,
    workers: int | None,
    here: Mapping[str, str],
) -> Iterator[Done]:
    """Solve jobs, keep their parts in a folder and tell of each as it is there, in no order.

    Args:
        engine: `serial`, `local` or `dask://HOST:PORT`.
        jobs: What is to be solved; taken only as fast as it is.
        folder: Of the run.
        workers: Processes of the engine `local`; None for as many as there are cores.
        here: Versions that a cluster's workers must have too.

    Raises:
        WorkerLost: A worker was killed.
        EnvironmentProblem: The scheduler does not answer, or its workers are of another version;
            the folder is full or not writable.
    """
    if engine == SERIAL:
        yield from (_kept(run_batch(job), folder) for job in jobs)
    elif engine == LOCAL:
        # A worker killed while it sends leaves the others waiting forever, so it keeps its part
        # itself and sends next to nothing.
        task = partial(_run_guarded, folder=folder, parent=os.getpid())
        yield from _parallel(task, jobs, workers or os.cpu_count() or 1, backend="loky")
    else:
        with _cluster(engine.removeprefix(DASK), here) as count:
            for part in _parallel(run_batch, jobs, count):
                yield _kept(part, folder)


def _kept(part: Part, folder: Folder) -> Done:
    folder.keep(part.batch, part.content)
    return Done(part.batch, part.failed)


def _run_guarded(job: Job, folder: Folder, parent: int) -> Done:
    guard.watch(parent)
    return _kept(run_batch(job), folder)


def _parallel(
    task: Callable[[Job], Found], jobs: Iterable[Job], workers: int, **backend: Any
) -> Iterator[Found]:
    """Do something with jobs through joblib, a few for each worker ahead."""
    from joblib import Parallel, delayed
    from joblib.externals.loky.process_executor import BrokenProcessPool

    pool = Parallel(
        n_jobs=workers,
        batch_size=1,
        pre_dispatch="3*n_jobs",
        return_as="generator_unordered",
        max_nbytes=None,  # no arrays in shared memory: a killed run would leave them there
        **backend,
    )
    try:
        yield from pool(delayed(task)(job) for job in jobs)
    except BrokenProcessPool as error:
        raise WorkerLost from error


@contextmanager
def _cluster(address: str, here: Mapping[str, str]) -> Iterator[int]:
    """Send joblib's work to a scheduler; gives the number of its threads.

    Raises:
        EnvironmentProblem: There is none, or limbik there is another.
        WorkerLost: The cluster gave up on a job because its workers kept dying.
    """
    try:
        from distributed import Client, KilledWorker
        from joblib import parallel_config
    except ImportError:
        message = "dask:// needs Dask: pip install 'limbik[dask]'"
        raise EnvironmentProblem(message) from None
    try:
        connect: Any = Client  # Dask's calls have no types
        client = connect(f"tcp://{address}", timeout=CONNECT, set_as_default=True)
    except (OSError, ValueError) as error:
        message = f"no Dask scheduler answers at {address}; start one with 'dask scheduler'"
        raise EnvironmentProblem(message) from error
    try:
        libraries = [name for name in here if name not in versions()]
        _check_versions(client.run(versions, libraries), here, address)
        with parallel_config(backend="dask"):
            yield sum(client.nthreads().values())
    except KilledWorker as error:
        raise WorkerLost from error
    except LimbikError:
        raise
    except (OSError, ModuleNotFoundError) as error:
        raise EnvironmentProblem(f"the cluster at {address} failed: {error}") from error
    finally:
        client.close()


def _check_versions(
    found: Mapping[str, Mapping[str, str]], here: Mapping[str, str], address: str
) -> None:
    """Refuse workers whose results might differ, and a cluster without any."""
    if not found:
        message = f"the scheduler at {address} has no workers; start some with 'dask worker'"
        raise EnvironmentProblem(message)
    lines = [
        f"{worker}: {name} {theirs.get(name)}, here {own}"
        for worker, theirs in found.items()
        for name, own in here.items()
        if theirs.get(name) != own
    ]
    if lines:
        raise EnvironmentProblem("workers of other versions:\n  " + "\n  ".join(lines[:20]))
