"""Plays a path: calls back at a steady rate with the time that has passed."""

from collections.abc import Callable
from threading import Event, Thread
from time import monotonic

RATE = 25.0  # calls a second


class Player:
    """A clock that can be started and stopped.

    Args:
        tick: Called with the seconds since the last call, on a thread of its own.
    """

    def __init__(self, tick: Callable[[float], None]) -> None:
        self._tick = tick
        self._halt = Event()
        self._thread: Thread | None = None

    @property
    def plays(self) -> bool:
        """Whether it runs."""
        return self._thread is not None and self._thread.is_alive() and not self._halt.is_set()

    def start(self) -> None:
        """Start the clock, unless it runs."""
        if not self.plays:
            self._halt = Event()
            self._thread = Thread(target=self._run, args=(self._halt,), daemon=True)
            self._thread.start()

    def stop(self) -> None:
        """Stop the clock."""
        self._halt.set()

    def _run(self, halt: Event) -> None:
        before = monotonic()
        while not halt.wait(1.0 / RATE):
            now = monotonic()
            self._tick(now - before)
            before = now
