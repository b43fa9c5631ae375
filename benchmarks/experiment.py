"""What an experiment costs beside the bare kernel: `python benchmarks/experiment.py [COUNT]`.

A million goals of the arm, drawn within its limits, on the same cores: once by `Solver.solve_many`
over an array that is there already, threads as cores; once by `limbik experiment run`, from the
start of the program to the last part on the disk. The machine may be shared: both in turns, each
run beside the mean of the bare loops before and after it. What counts is the ratio, and where
others compete for the cores that of processor times: wall times then tell who was given more of
them. The memory is that of the program and its workers.
"""

import os
import resource
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scene import read_scene
from limbik.core.solver import Solver
from limbik.core.solving import scene_solver
from limbik.plugins.experiments.goalsets import Reach, seed_of

ROOT = Path(__file__).resolve().parents[1]
ARM = ROOT / "configs" / "arm.yaml"
ROUNDS = 2
EXPERIMENT = """\
experiment: 1
name: million
seed: 7
chains: [{arm}]
goals: [{{kind: reach, count: {count}}}]
engine: local
output: {folder}/run
"""


def memory(root: int) -> int:
    """Return the memory of a process and its descendants, shared pages divided [bytes]."""
    total, waiting = 0, [root]
    while waiting:
        pid = waiting.pop()
        try:
            tasks = Path(f"/proc/{pid}/task")
            for task in tasks.iterdir():
                waiting += map(int, (task / "children").read_text().split())
            lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
            total += sum(1024 * int(line.split()[1]) for line in lines if line.startswith("Pss:"))
        except (OSError, ValueError):
            continue
    return total


def processor() -> float:
    """Return the processor time of the child processes that have ended, and of theirs [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(count: int) -> tuple[float, float, int, int]:
    """Return seconds, those of processors, most memory [bytes] and the parts' bytes of a run."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "million.yaml")
        file.write_text(EXPERIMENT.format(arm=ARM, count=count, folder=folder), encoding="utf-8")
        started, before = time.perf_counter(), processor()
        command = [sys.executable, "-m", "limbik", "experiment", "run", str(file)]
        child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        most = 0
        ended = threading.Event()

        def watch() -> None:
            nonlocal most
            while not ended.wait(0.25):
                most = max(most, memory(child.pid))

        watcher = threading.Thread(target=watch)
        watcher.start()
        status = child.wait()
        seconds, busy = time.perf_counter() - started, processor() - before
        ended.set()
        watcher.join()
        assert status == 0, status
        size = sum(part.stat().st_size for part in Path(folder, "run", "solves").iterdir())
    return seconds, busy, most, size


def bare(solver: Solver, goals: Array) -> tuple[float, float]:
    """Return seconds and those of processors that the solves alone take."""
    started, before = time.perf_counter(), time.process_time()
    for first in range(0, len(goals), 100_000):  # all at once would take 600 MB for nothing
        solver.solve_many(goals[first : first + 100_000])
    return time.perf_counter() - started, time.process_time() - before


def main() -> None:
    """Measure and print."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    scene = read_scene(ARM)
    solver = scene_solver(scene, Registry())
    goals = Reach(seed_of(7, "reach", 0), "joints", 0, count).positions(scene.chain)
    solver.solve_many(goals[:1000])
    walls, busies = [], []
    before = bare(solver, goals)
    for _ in range(ROUNDS):
        wall, busy, most, size = run(count)
        after = bare(solver, goals)
        bare_wall, bare_busy = (0.5 * (a + b) for a, b in zip(before, after, strict=True))
        before = after
        walls.append(wall / bare_wall)
        busies.append(busy / bare_busy)
        print(
            f"{count} solves on {os.cpu_count()} cores: bare {bare_wall:.1f} s, experiment "
            f"{wall:.1f} s, ratio {walls[-1]:.2f}; processors {bare_busy:.1f} s, {busy:.1f} s, "
            f"ratio {busies[-1]:.2f}; {most / 2**20:.0f} MiB, {size / count:.1f} bytes a row",
            flush=True,
        )
    for what, ratios in (("wall", walls), ("processors", busies)):
        print(f"ratio of {what}: {min(ratios):.2f} to {max(ratios):.2f}")


if __name__ == "__main__":
    main()
