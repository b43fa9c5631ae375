"""Where batches are solved: in this process, on all cores, or on a Dask cluster that is there."""

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from limbik.core.errors import EnvironmentProblem, LimbikError
from limbik.plugins.experiments import guard
from limbik.plugins.experiments.batch import Job, Part, run_batch
from limbik.plugins.experiments.identity import versions
from limbik.plugins.experiments.model import DASK, LOCAL, SERIAL

CONNECT = 5.0  # seconds a scheduler has to answer


class WorkerLost(Exception):
    """A worker process was ended from outside; what it had not finished can be done again."""


def run_jobs(
    engine: str, jobs: Iterable[Job], workers: int | None, here: Mapping[str, str]
) -> Iterator[Part]:
    """Solve jobs and give their parts as they are ready, in no order.

    Args:
        engine: `serial`, `local` or `dask://HOST:PORT`.
        jobs: What is to be solved; taken only as fast as it is.
        workers: Processes of the engine `local`; None for as many as there are cores.
        here: Versions that a cluster's workers must have too.

    Raises:
        WorkerLost: A worker was killed.
        EnvironmentProblem: The scheduler does not answer, or its workers are of another version.
    """
    if engine == SERIAL:
        yield from map(run_batch, jobs)
    elif engine == LOCAL:
        yield from _parallel(jobs, workers or os.cpu_count() or 1, backend="loky")
    else:
        with _cluster(engine.removeprefix(DASK), here) as count:
            yield from _parallel(jobs, count)


def _parallel(jobs: Iterable[Job], workers: int, **backend: Any) -> Iterator[Part]:
    """Solve jobs through joblib, a few for each worker ahead."""
    from joblib import Parallel, delayed
    from joblib.externals.loky.process_executor import BrokenProcessPool

    local = bool(backend)
    pool = Parallel(
        n_jobs=workers,
        batch_size=1,
        pre_dispatch="3*n_jobs",
        return_as="generator_unordered",
        max_nbytes=None,  # no arrays in shared memory: a killed run would leave them there
        **backend,
    )
    task = delayed(_guarded if local else run_batch)
    arguments = (os.getpid(),) if local else ()
    try:
        yield from pool(task(job, *arguments) for job in jobs)
    except BrokenProcessPool as error:
        raise WorkerLost from error


def _guarded(job: Job, parent: int) -> Part:
    guard.watch(parent)
    return run_batch(job)


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
