"""Whatever stands in a robot's or a clip's file, it is read or refused with a place."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from limbik.core.errors import Fault, InputError
from limbik.plugins.formats import bvh_chain, urdf_chain
from limbik.plugins.formats.bvh import read_bvh

JUNK = st.one_of(
    st.binary(max_size=20),
    st.sampled_from([b"0", b"-1e999", b'"', b"<", b"}", b"{", b"nan", b"\xff", b"JOINT a\n{\n"]),
)


def faults_of(read: Callable[[Path], object], path: Path) -> tuple[Fault, ...]:
    try:
        read(path)
    except InputError as error:
        return error.faults
    return ()


@given(junk=JUNK, at=st.integers(0, 2000), dropped=st.integers(0, 40))
@example(junk=b"", at=0, dropped=40)
def test_a_mutated_robot(
    tmp_path_factory: pytest.TempPathFactory, robot_text: str, junk: bytes, at: int, dropped: int
) -> None:
    path = _file(tmp_path_factory, "mutated.urdf")
    source = robot_text.encode()
    path.write_bytes(source[:at] + junk + source[at + dropped :])
    faults = faults_of(urdf_chain.inspect, path)
    assert all(fault.line >= 1 and fault.column >= 1 for fault in faults)


@given(junk=JUNK, at=st.integers(0, 1500), dropped=st.integers(0, 40))
def test_a_mutated_clip(
    tmp_path_factory: pytest.TempPathFactory,
    walker: Callable[..., str],
    junk: bytes,
    at: int,
    dropped: int,
) -> None:
    path = _file(tmp_path_factory, "mutated.bvh")
    source = walker(2).encode()
    path.write_bytes(source[:at] + junk + source[at + dropped :])
    faults = faults_of(bvh_chain.inspect, path)
    assert all(fault.line >= 1 for fault in faults)
    if not faults:
        assert np.isfinite(read_bvh(path).frames).all()


def _file(factory: pytest.TempPathFactory, name: str) -> Path:
    """A file of this session, written anew by each example."""
    return factory.getbasetemp() / name
