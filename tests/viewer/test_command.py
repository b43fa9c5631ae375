"""`limbik view` as a process: it says where it is, answers, and ends on Ctrl-C without a trace."""

import os
import signal
import subprocess
import urllib.request
from pathlib import Path

import pytest

from limbik.core.errors import EnvironmentProblem, InputError
from limbik.plugins.viewer import server
from limbik.tests.viewer.process import limbik, viewing


def test_without_viser_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "find_spec", lambda name: None)
    with pytest.raises(EnvironmentProblem, match=r"pip install 'limbik\[view\]'"):
        server.check_viewer()


def test_an_address_of_another_machine_is_refused_and_loopback_is_known() -> None:
    for host in ("203.0.113.1", "no.such.host.invalid"):
        with pytest.raises(InputError, match="--host: cannot listen at"):
            server.is_loopback(host)
    assert server.is_loopback("127.0.0.1")
    assert not server.is_loopback("0.0.0.0")


def test_a_scene_with_a_fault_is_no_reason_to_serve(tmp_path: Path) -> None:
    pytest.importorskip("viser", reason="the extra 'view' is not installed")
    bad = tmp_path / "bad.yaml"
    bad.write_text("limbik: 1\ngoals: []\n", encoding="utf-8")
    done = subprocess.run(
        limbik("view", str(bad), "--port", "0"), capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert "bad.yaml:" in done.stderr
    assert done.stdout == ""


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="sends a signal of POSIX")
def test_it_serves_until_it_is_interrupted() -> None:
    pytest.importorskip("viser", reason="the extra 'view' is not installed")
    with viewing("arm") as (process, url):
        with urllib.request.urlopen(url, timeout=20) as answer:
            assert b"<html" in answer.read(4000).lower()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert process.returncode == 0
    assert out == ""
    assert "Traceback" not in err
