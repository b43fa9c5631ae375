"""Trajectories are those an independent implementation of the source gave.

`LIMBIK_GOLDEN` names another folder with files of the same form. The cases name their options in
the source's words; what they leave out is as printed (uniform spline, rotation by the parameter,
tangents of length L1 + L2), which limbik's own defaults are not.
"""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limbik.core.errors import InputError
from limbik.core.rotation import matrix_to_quaternion, quaternion_to_matrix
from limbik.plugins.paths.arc import Arc as ArcShape
from limbik.plugins.paths.arc import arc_about, arc_through
from limbik.plugins.paths.cubic import Cubic, hermite, spline
from limbik.plugins.paths.moves import Drive
from limbik.plugins.paths.profile import Profile
from limbik.plugins.paths.quaternions import double_slerp, half_angle, short_way, slerp
from limbik.plugins.paths.ramps import Rates, from_ramp_times, profile
from limbik.plugins.paths.shapes import Polyline, Shape
from limbik.trajectory import (
    Arc,
    ArcAbout,
    Blend,
    KeyPoint,
    Limits,
    Line,
    Overlap,
    Spline,
    Stop,
    Trajectory,
    overlap_samples,
    plan,
)

Case = dict[str, Any]

FOLDER = Path(os.environ.get("LIMBIK_GOLDEN") or Path(__file__).parent / "golden")
TIGHT, COARSE = 2e-9, 1e-4  # the cases' inputs and outputs are rounded to nine digits


def load() -> list[Case]:
    path = FOLDER / "trajectory.json"
    if not path.exists():
        return []
    cases: list[Case] = json.loads(path.read_text(encoding="utf-8"))["cases"]
    return cases


def near(found: Any, expected: Any, what: str, within: float = TIGHT) -> None:
    found, expected = np.asarray(found, float), np.asarray(expected, float)
    size = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(found, expected, rtol=0, atol=within * size, err_msg=what)


def same_rotations(found: Any, expected: Any, what: str) -> None:
    q1, q2 = np.asarray(found, float), np.asarray(expected, float)
    q2 = q2 / np.linalg.norm(q2, axis=-1, keepdims=True)
    assert np.max(2.0 * half_angle(q1, short_way(q1, q2))) <= 2.0 * TIGHT, what


def path_of(given: Case) -> Shape:
    kind, points = given["type"], np.array(given.get("points", [[0, 0, 0]]), float)
    if kind == "spline":
        return spline(points, given.get("param", "uniform"))
    if kind in ("arc_center", "arc_about"):
        start = np.array(given.get("start", points[0]), float)
        center, axis = np.array(given["center"], float), np.array(given["axis"], float)
        return arc_about(start, center, axis, given["angle"])
    return Polyline(points) if kind == "line" else arc_through(points, given.get("full", False))


def limits_of(move: Case) -> Limits:
    ramps = (move["Ta"], move["Td"]) if "Ta" in move else None
    return Limits(
        move.get("v", 1.0),
        move.get("a") if ramps is None else None,
        move.get("d"),
        ramp_times=ramps,
        short=move.get("short", "keep-accelerations").replace("_", "-"),
        rotation_speed=move.get("w"),
        rotation_acceleration=move.get("aw"),
    )


def sections(moves: list[Case], key_points: int) -> list[int]:
    """How many sections each move takes; one spline takes what the others leave."""
    fixed = {"line": 1, "arc": 2, "arc_center": 0}
    told = [move.get("n") or move.get("sections") or fixed.get(move["type"]) for move in moves]
    rest = key_points - 1 - sum(count for count in told if count is not None)
    open_ones = max(sum(count is None for count in told), 1)
    return [rest // open_ones if count is None else count for count in told]


def move_of(move: Case, points: list[KeyPoint]) -> Any:
    limits, smooth = limits_of(move), move.get("smooth_w", 0.0)
    if move["type"] == "line":
        return Line(points[0], limits)
    if move["type"] == "arc":
        via, full = move.get("via", "through"), move.get("full", False)
        return Arc(points[0], points[1], limits, full, via, smooth)
    if move["type"] == "arc_center":
        return ArcAbout(move["center"], move["axis"], move["angle"], limits=limits)
    drive: Drive = "length" if move.get("by", "s") == "length" else "parameter"
    return Spline(points, limits, move.get("param", "uniform"), drive, smooth)


def junction_of(junction: Case) -> Any:
    if junction["type"] == "blend":
        return Blend(
            junction["L1"],
            junction.get("L2"),
            junction.get("tangent", "sum"),
            junction.get("speed", "ramp"),
            junction.get("a_n"),
            "linear" if junction.get("orient") == "linear" else "smooth",
        )
    if junction["type"] == "ovv":
        return Overlap(junction["t_ov"])
    return Stop()


def trajectory_of(given: Case) -> Trajectory:
    points = [KeyPoint.from_matrix(matrix) for matrix in given["key_points"]]
    moves = given["moves"]
    junctions = given.get("junctions")
    junctions = (
        [{"type": "stop"}] * (len(moves) - 1) if not isinstance(junctions, list) else junctions
    )
    steps: list[Any] = []
    place = 0
    for k, (move, count) in enumerate(zip(moves, sections(moves, len(points)), strict=True)):
        steps += [junction_of(junctions[k - 1])] if k else []
        steps.append(move_of(move, points[place + 1 : place + count + 1]))
        place += count
    return plan(points[0], steps, order=given.get("order", "base"))


def profile_of(given: Case) -> Profile:
    if "Ta" in given:
        short = given.get("short", "keep-accelerations").replace("_", "-")
        rates = from_ramp_times(given["D"], given["v"], given["Ta"], given["Td"], short)
    else:
        rates = Rates(given["v"], given["a"], given.get("d") or given["a"])
    return profile(given["D"], rates, given.get("v0", 0.0), given.get("v1", 0.0))


def check_quaternion(given: Case, expect: Case) -> None:
    found = matrix_to_quaternion(given["R"])
    same_rotations(found, expect["q"], "q")
    near(quaternion_to_matrix(found), expect["R_back"], "R_back")


def check_slerp(given: Case, expect: Case) -> None:
    q0, q1 = np.array(given["q0"]), np.array(given["q1"])
    same_rotations(slerp(given["r"], q0, q1), expect["q"], "q")
    near(2.0 * half_angle(q0, short_way(q0, q1)), expect["rotation_angle"], "rotation_angle")


def check_smooth(given: Case, expect: Case) -> None:
    before, middle, after = (np.array(given[k]) for k in ("q_prev", "q_kp", "q_next"))
    start, goal = slerp(1.0 - given["w"], before, middle), slerp(given["w"], middle, after)
    same_rotations(double_slerp(given["t"], start, middle, goal), expect["q"], "q")


def check_trapezoid(given: Case, expect: Case) -> None:
    found = profile_of(given)
    x, v, _ = found.at(np.array(expect["t"]))
    near(found.duration, expect["T"], "T")
    near(found.peak, expect["peak"], "peak")
    near(x, expect["pos"], "pos")
    near(v, expect["vel"], "vel")
    up = sum(p.duration for p in found.phases if p.acceleration > 0.0)
    flat = sum(p.duration for p in found.phases if p.acceleration == 0.0)
    near([up, flat], [expect["ta"], expect["tc"]], "ramps")


def check_path(given: Case, expect: Case) -> None:
    shape = path_of(given)
    x = np.array(expect["x"])
    points, tangents = shape.at(x)
    near(shape.knots[-1], expect["length"], "length")
    near(shape.knots, expect["knots"], "knots")
    near(points, expect["point"], "point")
    near(tangents, expect["tangent"], "tangent", 1e-8)
    near(shape.curvature(x), expect["curvature"], "curvature", 1e-7)
    near(shape.parameter(x), expect["s"], "s", 1e-8)
    if isinstance(shape, ArcShape) and "center" in expect:
        near(shape.center, expect["center"], "center")
        near([shape.radius, shape.sweep], [expect["R"], expect["sweep"]], "R and sweep")
        thetas = [-shape.angles[1], 0.0, shape.angles[2] - shape.angles[1]]
        near(thetas, expect.get("thetas", thetas)[:3], "thetas")
    if isinstance(shape, Cubic) and "coef_abcd" in expect:
        near(shape.coefficients, expect["coef_abcd"], "coefficients")


def check_hermite(given: Case, expect: Case) -> None:
    curve = hermite(*(np.array(given[k], float) for k in ("Q1", "Q2", "V1", "V2")))
    a, b, c, d = curve.coefficients[0]
    s = np.array(expect["s"])[:, None]
    near(curve.coefficients[0], np.reshape(expect["coef_abcd"], (4, 3)), "coefficients")
    near(a + s * (b + s * (c + s * d)), expect["F"], "F")
    near(curve.knots[-1], expect["length"], "length")


def check_program(given: Case, expect: Case) -> None:
    found = trajectory_of(given)
    near(found.duration, expect["T"], "T")
    near([piece.duration for piece in found.pieces], expect["piece_durations"], "durations")
    samples = found.at(expect["t"])
    near(samples.positions, expect["P"], "P")
    near(samples.velocities, expect["V"], "V", 1e-8)
    same_rotations(samples.quaternions, expect["q"], "q")
    fine = found.at(np.linspace(0.0, found.duration, 4001))
    near(fine.speeds.max(), expect["coarse"]["max_speed"], "max_speed", COARSE)
    gaps = [
        np.linalg.norm(fine.positions - np.array(matrix)[:3, 3], axis=1).min()
        for matrix in given["key_points"]
    ]
    near(gaps, expect["coarse"]["closest_to_key_points"], "closest", COARSE)


def check_sampled(given: Case, expect: Case) -> None:
    found = trajectory_of(given["program"])
    samples = found.sample(given["dt"])
    near(samples.positions, expect["P_in"], "P_in")
    near(samples.rotations, expect["R_in"], "R_in")
    places, turned = overlap_samples(samples.positions, samples.rotations, given["jm"], given["nj"])
    near(places, expect["P"], "P")
    near(turned, expect["R"], "R")


CHECKS = {
    "quat_from_matrix": check_quaternion,
    "slerp": check_slerp,
    "smooth_orientation": check_smooth,
    "trapezoid": check_trapezoid,
    "path": check_path,
    "hermite": check_hermite,
    "program": check_program,
    "ovv_sampled": check_sampled,
}
MAKERS = {"trapezoid": profile_of, "path": path_of, "program": trajectory_of}


@pytest.mark.parametrize("case", load(), ids=lambda case: case["id"])
def test_a_case_gives_what_the_independent_implementation_gave(case: Case) -> None:
    if "error" in case["expect"]:
        with pytest.raises(InputError):
            MAKERS[case["kind"]](case["input"])
    else:
        CHECKS[case["kind"]](case["input"], case["expect"])
