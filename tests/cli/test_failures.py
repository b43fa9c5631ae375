"""Every exit status above 1: its message, its JSON, and no traceback."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from limbik.core.errors import PluginError

Run = Callable[..., tuple[int, str, str]]


def without_compiling(text: str) -> str:
    """Stderr without the line that says that machine code is being compiled."""
    return "".join(line for line in text.splitlines(True) if "compiling" not in line)


def raiser(error: BaseException) -> Callable[..., Any]:
    """A function that raises."""

    def fail(*_: Any, **__: Any) -> Any:
        raise error

    return fail


@pytest.mark.parametrize(
    "arguments", [("slove",), ("solve",), ("solve", "a.yaml", "--plott"), ("check",)]
)
def test_wrong_usage_ends_with_2_and_says_so_on_stderr(
    run: Run, arguments: tuple[str, ...]
) -> None:
    status, out, err = run(*arguments)

    assert (status, out) == (2, "")
    assert "Usage" in err


@pytest.mark.parametrize("command", ["solve", "check"])
def test_a_missing_scene_ends_with_2_and_its_name(run: Run, command: str) -> None:
    status, out, err = run(command, "none.yaml")

    assert (status, out) == (2, "")
    assert err == (
        "none.yaml: error[unreadable]: cannot read the file: No such file or directory\n"
    )


@pytest.mark.parametrize("command", ["solve", "check"])
def test_faults_are_json_on_stdout_and_text_on_stderr(
    run: Run, command: str, tmp_path: Path, scene_text: str
) -> None:
    (tmp_path / "bad.yaml").write_text(scene_text.replace("pitch", "picth"), encoding="utf-8")
    status, out, err = run(command, "bad.yaml", "--json")
    record = json.loads(out)

    assert (status, record["schema"], record["status"]) == (2, 1, "bad-input")
    assert record["errors"] == [
        {
            "code": "unknown-key",
            "message": "unknown key 'picth'",
            "key": "chain.joints[1].picth",
            "file": "bad.yaml",
            "line": 5,
            "column": 41,
            "hint": "did you mean 'pitch'?",
        }
    ]
    assert err.startswith("bad.yaml:5:41: error[unknown-key]")


def test_a_folder_that_is_not_there_ends_with_3_and_leaves_nothing(
    run: Run, scene: str, tmp_path: Path
) -> None:
    before = sorted(tmp_path.iterdir())
    status, _, err = run("solve", scene, "--csv", "none/out.csv")

    assert status == 3
    assert "limbik: cannot write none/out.csv: No such file or directory" in err
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("error", "status", "label", "words"),
    [
        (
            PluginError("it fell over", "acme", "spin", "initial_bend"),
            4,
            "plugin-error",
            "limbik: plug-in 'acme', initial_bend 'spin': it fell over",
        ),
        (
            ZeroDivisionError("oops"),
            70,
            "internal",
            "limbik: a bug in limbik: ZeroDivisionError: oops\nPlease report it",
        ),
        (KeyboardInterrupt(), 130, "interrupted", "limbik: interrupted"),
    ],
)
def test_every_other_failure_has_its_status_and_no_traceback(
    run: Run,
    scene: str,
    monkeypatch: pytest.MonkeyPatch,
    error: BaseException,
    status: int,
    label: str,
    words: str,
) -> None:
    monkeypatch.delenv("LIMBIK_DEBUG", raising=False)
    monkeypatch.setattr("limbik.core.solving.solve_scene", raiser(error))
    code, out, err = run("solve", scene, "--json")

    assert (code, json.loads(out)["status"]) == (status, label)
    assert without_compiling(err).startswith(words)
    assert "Traceback" not in err


def test_debug_shows_the_traceback_of_a_bug(
    run: Run, scene: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LIMBIK_DEBUG", "1")
    monkeypatch.setattr("limbik.core.solving.solve_scene", raiser(ZeroDivisionError("oops")))
    code, _, err = run("solve", scene)

    assert code == 70
    assert "Traceback" in err


def test_a_plug_in_that_gives_no_number_ends_with_4_and_its_name(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, scene_text: str
) -> None:
    """A real plug-in, found by its entry point; the root of a negative number is no number."""
    (tmp_path / "acme_not.py").write_text(
        "import limbik\n\n\n"
        "def bad(lengths, reach_ratio, weights, params, angles):\n"
        "    for bone in range(angles.shape[0]):\n"
        "        angles[bone] = (reach_ratio - 2.0) ** 0.5\n\n\n"
        "@limbik.hookimpl\ndef limbik_initial_bends():\n"
        "    return [limbik.Strategy('bad', bad)]\n",
        encoding="utf-8",
    )
    dist = tmp_path / "acme_not-1.0.dist-info"
    dist.mkdir()
    (dist / "METADATA").write_text("Metadata-Version: 2.1\nName: acme-not\nVersion: 1.0\n")
    (dist / "entry_points.txt").write_text("[limbik]\nacme = acme_not\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "scene.yaml").write_text(
        scene_text.replace("{max_iterations: 100}", "{initial_bend: bad}"), encoding="utf-8"
    )
    status, out, err = run("solve", "scene.yaml")

    assert (status, out) == (4, "")
    assert "limbik: plug-in 'acme', initial_bend 'bad': " in err
