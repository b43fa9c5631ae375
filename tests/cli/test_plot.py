"""Pictures: the kind of file, what is in them, what stands in their way."""

from collections.abc import Callable
from pathlib import Path

import pytest

Run = Callable[..., tuple[int, str, str]]


@pytest.mark.parametrize(("name", "mark"), [("p.png", b"\x89PNG"), ("p.svg", b"<?xml")])
def test_plot_writes_the_kind_of_file_its_ending_says(
    run: Run, scene: str, tmp_path: Path, name: str, mark: bytes
) -> None:
    pytest.importorskip("matplotlib")
    status, _, _ = run("solve", scene, "--plot", name)

    assert status == 0
    assert (tmp_path / name).read_bytes().startswith(mark)


def test_a_picture_names_goals_stages_and_joints_at_limits(
    run: Run, tmp_path: Path, scene_text: str
) -> None:
    """The straight arm cannot bend up: its elbow rests on the limit and the picture says so."""
    pytest.importorskip("matplotlib")
    import matplotlib as mpl

    text = scene_text.replace("[-145, 0]", "[-30, 0]").replace("[5, 10, 40]", "[0, 0, 20]")
    text = text.replace("max_iterations: 100", "max_iterations: 100, finish: none")
    (tmp_path / "scene.yaml").write_text(text, encoding="utf-8")
    with mpl.rc_context({"svg.fonttype": "none"}):  # text stays text
        run("solve", "scene.yaml", "--plot", "p.svg")
    picture = (tmp_path / "p.svg").read_text(encoding="utf-8")

    words = ("near", "low", "initial bend", "aim", "final", "joint at a limit", "elbow pitch")
    assert [word for word in words if word not in picture] == []


def test_the_same_scene_gives_the_same_picture(run: Run, scene: str, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    for name in ("a.svg", "b.svg"):
        run("solve", scene, "--plot", name)

    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def test_a_plot_with_another_ending_is_refused_before_solving(run: Run, scene: str) -> None:
    status, out, err = run("solve", scene, "--plot", "p.bmp")

    assert (status, out) == (2, "")
    assert "must end in .png, .svg, .pdf, not 'p.bmp'" in err


def test_a_plot_without_matplotlib_ends_with_3_and_names_the_extra(
    run: Run, scene: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("limbik.plugins.output.plot.find_spec", lambda name: None)
    status, out, err = run("solve", scene, "--plot", "p.png")

    assert (status, out) == (3, "")
    assert err == "limbik: drawing needs matplotlib: pip install 'limbik[plot]'\n"


def test_a_picture_of_the_2d_solver_shows_plane_and_every_stage(run: Run, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    import matplotlib as mpl

    text = """\
limbik: 1
solver: 2d
chain:
  joints:
    - {name: hip}
    - {name: knee, offset: [0, 0, 43], planar: [-50, 0]}
    - {name: ankle, offset: [0, 0, 40]}
    - {name: toe, offset: [0, 0, 14]}
pole: {position: [20, 70, 30]}
goals: [{name: step, position: [25, 5, 55]}]
"""
    (tmp_path / "plane.yaml").write_text(text, encoding="utf-8")
    with mpl.rc_context({"svg.fonttype": "none"}):  # text stays text
        run("solve", "plane.yaml", "--plot", "p.svg")
    picture = (tmp_path / "p.svg").read_text(encoding="utf-8")

    words = ("IK plane", "pole and IK plane", "simple aim", "axis to pole", "with FK", "CCD rounds",
             "initial bend", "knee -50°", "at limit: knee planar")  # fmt: skip
    assert [word for word in words if word not in picture] == []
