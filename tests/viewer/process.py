"""`limbik view` as a process of its own."""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from limbik.tests.viewer.scenes import CONFIGS


def limbik(*arguments: str) -> list[str]:
    """A command line of limbik."""
    return [sys.executable, "-m", "limbik", *arguments]


@contextmanager
def viewing(scene: str, *options: str) -> Iterator[tuple["subprocess.Popen[str]", str]]:
    """Run `limbik view` with a shipped scene; give the process and the address it says."""
    ours = signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background
    try:  # ignores Ctrl-C, and so would what it starts
        process = subprocess.Popen(
            limbik("view", str(CONFIGS / f"{scene}.yaml"), "--port", "0", *options),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=os.environ | {"PYTHONUNBUFFERED": "1"},
        )
    finally:
        signal.signal(signal.SIGINT, ours)
    assert process.stdout is not None
    try:
        said = process.stdout.readline()
        found = re.search(r"is at (http://127\.0\.0\.1:\d+) ", said)
        assert found, said
        yield process, found[1]
    finally:
        process.kill()
        process.wait()
