"""The 2D solver gives the poses an independent implementation of the source gave.

`LIMBIK_GOLDEN` names another folder with files of the same form.
"""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.rotation import hpb_to_matrix
from limbik.core.solution import Continuity
from limbik.core.solution2d import PlanarSolution
from limbik.core.solver2d import Solver2D

Case = dict[str, Any]

FOLDER = Path(os.environ.get("LIMBIK_GOLDEN") or Path(__file__).parent / "golden")
STAGES = ("aim", "initial_bend", "ccd_1", "ccd_2", "ccd_5", "ccd_10", "final")
EARLY = ("aim", "initial_bend")


def load() -> list[Case]:
    path = FOLDER / "solver2d.json"
    if not path.exists():
        return []
    cases: list[Case] = json.loads(path.read_text(encoding="utf-8"))["cases"]
    return cases


def triple(values: Any) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z


def case_chain(case: Case) -> Chain:
    """Return a case's chain; its limits are the planar joints'."""
    joints = [
        Joint.degrees(
            f"j{number}",
            triple(joint["offset"]),
            triple(joint.get("frozen_rot", (0, 0, 0))),
            triple(joint.get("init", (0, 0, 0))),
            planar=None if joint.get("limit") is None else tuple(joint["limit"]),
        )
        for number, joint in enumerate(case["input"]["joints"])
    ]
    parent = case["input"].get("parent") or {"pos": (0, 0, 0), "hpb": (0, 0, 0)}
    base = Joint.degrees("base", frozen=triple(parent["hpb"])).frozen
    return Chain(joints, triple(parent["pos"]), base)


def solve_case(case: Case, stage: str) -> PlanarSolution:
    """Solve a case up to a stage."""
    given, bend, options = case["input"], case["input"].get("bend", {}), case["input"].get
    opts = options("options", {})
    most = {"aim": -1, "initial_bend": 0, "final": opts.get("max_iterations", 20)}
    limit = most.get(stage, opts.get("max_iterations", 20))
    if stage.startswith("ccd_"):
        limit = int(stage.removeprefix("ccd_"))
    chain = case_chain(case)
    solver = Solver2D(
        chain,
        pole=given["pole"],
        bend_reference=bend.get("ref", 1),
        reference_axis=bend.get("axis", "Y+").lower(),
        twist=float(bend.get("twist", 0)),
        tolerance=float(opts.get("threshold", 0.01)),
        max_iterations=limit,
        max_violations=opts.get("max_excess", 0),
        coefficient_base=float(opts.get("bend_coef_base", 1.0)),
        weight_range=(
            float(opts.get("bend_weight_min", 0.0)),
            float(opts.get("bend_weight_max", 0.0)),
        ),
        held={
            "base": opts.get("fix_start", 0),
            "end": opts.get("fix_end", 0),
            "bend_base": opts.get("fix_start_apply", False),
            "bend_end": opts.get("fix_end_apply", False),
        },
        fk_strength=float(given.get("fk_strength", 1.0)),
    )
    inits = [joint.get("init", (0, 0, 0)) for joint in given["joints"]]
    current = [
        joint.get("current", init) for joint, init in zip(given["joints"], inits, strict=True)
    ]
    fk = given.get("fk")
    return solver.solve(
        given["controller"],
        fk_offsets=None if fk is None else np.radians(fk),
        continuity=Continuity.from_pose(np.radians(current), 1),
    )


CASES = load()


EXACT = [
    pytest.param(case, stage, id=f"{case['name']}-{stage}")
    for case in CASES
    for stage in STAGES
    if stage in case["exact_stages"]
]


@pytest.mark.parametrize(
    ("case", "stage"), EXACT, ids=lambda it: it if isinstance(it, str) else str(it["name"])
)
def test_exact_stages_give_the_golden_pose(case: Case, stage: str) -> None:
    solution, expected = solve_case(case, stage), case["expect"][stage]
    tolerance = 1e-6 if stage in EARLY else 1e-5

    np.testing.assert_allclose(
        solution.positions, expected["positions"], rtol=0, atol=tolerance * case_chain(case).length
    )
    np.testing.assert_allclose(
        hpb_to_matrix(solution.angles),
        hpb_to_matrix(np.radians(expected["hpb"])),
        rtol=0,
        atol=max(tolerance, 1e-6),
    )


@pytest.mark.parametrize("case", CASES, ids=lambda case: str(case["name"]))
def test_every_case_ends_at_least_as_near_as_the_bare_document(case: Case) -> None:
    solution = solve_case(case, "final")

    assert solution.distance <= max(case["expect_distance_final"] * (1 + 1e-6), 0.01)
