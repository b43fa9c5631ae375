"""Workers that leave with the process that started them, however it ends."""

import os
import threading
import time
from functools import cache

INTERVAL = 0.25  # [s]


@cache
def watch(parent: int) -> None:
    """End this process when its parent is another than `parent`; looked at four times a second.

    An orphaned worker would wait for work until its pool's timeout, which takes minutes.
    """

    def wait() -> None:
        while os.getppid() == parent:
            time.sleep(INTERVAL)
        os._exit(1)

    if os.getppid() == parent and os.name == "posix":
        threading.Thread(target=wait, daemon=True, name="limbik-guard").start()
