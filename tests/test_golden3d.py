"""The 3D solver gives the poses an independent implementation of the source gave.

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
from limbik.core.settings import Settings
from limbik.core.solution import Continuity, Solution
from limbik.core.solver import Solver

Case = dict[str, Any]

FOLDER = Path(os.environ.get("LIMBIK_GOLDEN") or Path(__file__).parent / "golden")
CONE_AXES = ("x+", "x-", "y+", "y-", "z+", "z-")


def load() -> list[Case]:
    path = FOLDER / "solver3d.json"
    if not path.exists():
        return []
    cases: list[Case] = json.loads(path.read_text(encoding="utf-8"))["cases"]
    return cases


def case_chain(case: Case) -> Chain:
    """Return a case's chain."""
    joints = []
    for number, joint in enumerate(case["joints"]):
        limits = joint.get("limits", {})
        joints.append(
            Joint.degrees(
                f"j{number}",
                tuple(joint["offset"]),
                tuple(joint.get("frozen_rot", (0, 0, 0))),
                tuple(joint.get("init", (0, 0, 0))),
                *(tuple(limits[axis]) if axis in limits else None for axis in "hpb"),
            )
        )
    base = Joint.degrees("base", frozen=tuple(case["base_hpb"])).frozen
    return Chain(joints, tuple(case["base_position"]), base)


def case_settings(case: Case, step: Case, stage: str, first: bool) -> Settings:
    """Return a step's settings, stopped at a stage (`-2`, `-1`, `0` or `N`)."""
    options, bend, vector = case["options"], {**case["bend"], **step.get("bend", {})}, step["bendv"]
    cone = None
    if vector["forb_axis"] >= 0 and vector["forb_angle"] > 0 and vector["forb_op"] != "none":
        entry = "stop" if vector["forb_op"] == "stop" else "go-around"
        cone = {
            "axis": CONE_AXES[vector["forb_axis"]],
            "half_angle": float(vector["forb_angle"]),
            "entry": entry,
        }
    given: dict[str, Any] = {
        "tolerance": options["threshold"],
        "max_iterations": options["max_iter"] if stage == "N" else int(stage),
        "smoothing": options["ccd_smooth"],
        "max_violations": options["max_excess"],
        "held": {
            "base": options["fix_start"],
            "end": options["fix_end"],
            "bend_base": options["fix_apply_start"],
            "bend_end": options["fix_apply_end"],
        },
        "coefficient_base": options["bend_coef_base"],
        "weight_range": tuple(options["bend_weight"]),
        "bend_reference": bend["bend_ref"],
        "reference_axis": bend["ref_axis"],
        "twist": float(bend["twist"]),
        "aim_twist": options["aim_twist"],
        "off_axis": options["non_z"],
        "aim_from": "previous",
        "bank_lock": bend["fix_b"],
        "forbidden_cone": cone,
        "bend_smoothing": options["bendv_smooth_angle"],
        "bend_vector": _bend_vector(vector),
        "root_control": _root_control(bend["root_control"]),
        "bank_suppression": _bank_suppression(options),
        "finish": "none",
        "fk_strength": float(step["fk_strength"]),
        # In the global mode the source's "fixed" means: make the vector perpendicular (3D A-13).
        "hold_bend_vector": vector["fixed"] and vector["method"] == "manual" and not first,
    }
    return Settings(**given)


def _bend_vector(vector: Case) -> dict[str, Any]:
    if vector["method"] == "global":
        return {"use": "global", "direction": [float(value) for value in vector["dir"]]}
    chosen: dict[str, Any] = {"use": vector["method"], "angle": float(vector["dir"][2])}
    if vector["method"] == "auto":
        return chosen | {
            "sensitivity": vector["auto_sens"],
            "strength": vector["auto_strength"],
        }
    return chosen | {"exclude_bank": vector["exclude_bank"]}


def _root_control(name: str) -> str:
    known = {"none": "none", "suppress": "suppress-flip", "prefer": "prefer-flip"}
    return next(control for word, control in known.items() if word in name)


def _bank_suppression(options: Case) -> Any:
    if options["b_suppress_angle"] == 0.0:
        return "none"
    return {
        "use": "threshold",
        "angle": float(options["b_suppress_angle"]),
        "heading_correction": options["b_suppress_h_comp"],
        "all_stages": options["b_suppress_all"],
    }


CASES = load()
STAGES = ("-2", "-1", "0", "N")


def solve_steps(case: Case, stage: str) -> list[Solution]:
    """Solve a case's steps in order, continuity from the initial pose handed on."""
    chain = case_chain(case)
    continuity = Continuity.from_pose(chain.rest, case["bend"]["bend_ref"])
    solutions = []
    for number, step in enumerate(case["steps"]):
        solver = Solver(chain, case_settings(case, step, stage, number == 0))
        fk = np.radians(step["fk"])
        solution = solver.solve(step["controller"], fk_offsets=fk, continuity=continuity)
        continuity = solution.continuity or continuity
        solutions.append(solution)
    return solutions


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
    length = case_chain(case).length

    for solution, expected in zip(solve_steps(case, stage), case["expect"][stage], strict=True):
        np.testing.assert_allclose(
            solution.positions, expected["positions"], rtol=0, atol=1e-6 * length
        )
        np.testing.assert_allclose(
            hpb_to_matrix(solution.angles),
            hpb_to_matrix(np.radians(expected["hpb"])),
            rtol=0,
            atol=1e-6,
        )
        assert solution.iterations == expected["iterations"]
        if stage != "-2":
            np.testing.assert_allclose(solution.bend_vector, expected["bend_vector"], atol=1e-6)


@pytest.mark.parametrize("case", CASES, ids=lambda case: str(case["name"]))
def test_every_case_ends_at_least_as_near_as_the_bare_document(case: Case) -> None:
    tolerance = case["options"]["threshold"]

    for solution, error in zip(solve_steps(case, "N"), case["expect_error_N"], strict=True):
        assert solution.distance <= max(error * (1 + 1e-6), tolerance)
