"""Solvers that other processes can be given: copied and pickled without what is compiled."""

from typing import Any, Final, Self

OWN_PROCESS: Final = ("_kernel", "_plugs", "strategies", "limits")
"""Attributes of a solver that hold addresses or compiled code."""


class Portable:
    """Copies share what is compiled; what is pickled looks its strategies up where it arrives."""

    def _look_up(self) -> None:
        """Find the strategies anew."""
        raise NotImplementedError

    def __copy__(self) -> Self:
        found = object.__new__(type(self))
        found.__dict__.update(self.__dict__)
        return found

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name not in OWN_PROCESS}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._look_up()
