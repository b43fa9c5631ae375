"""`python -m limbik.core.warm`: compile what a first solve will ask for after its own kernel.

The compiler uses one core a process, and a first solve takes it for half a minute. The command
line starts this beside the first solve; what both compile goes through the cache.
"""

import os
import subprocess
import sys

from limbik.core import cache
from limbik.core.chain import Chain, Joint
from limbik.core.flatten import flat_plugs
from limbik.core.registry import Registry
from limbik.core.solver import Solver

_STARTED: list["subprocess.Popen[bytes]"] = []


def start() -> None:
    """Compile the default strategies in a process beside this one, if that helps.

    It does not without a second core or a place to keep machine code.
    """
    if (os.cpu_count() or 1) > 1 and cache.root() is not None:
        quiet = subprocess.DEVNULL
        command = [sys.executable, "-m", __name__]
        _STARTED.append(subprocess.Popen(command, stdin=quiet, stdout=quiet, stderr=quiet))


def main() -> None:
    """Compile the default strategies into the cache."""
    joints = [Joint("base"), Joint("end", (0.0, 0.0, 1.0))]
    solver = Solver(Chain(joints), registry=Registry(third_party=False))
    flat_plugs(solver.chain, solver.settings, solver.strategies, solver.limits)


if __name__ == "__main__":
    main()
