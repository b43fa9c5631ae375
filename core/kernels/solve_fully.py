"""The 3D solve with what few solves ask for: a choice among solutions, an end that takes a turn.

It is compiled where it is asked for; `solve_goals` stays as short as most solves need it.
"""

from math import isnan

from limbik.core.jit import entry
from limbik.core.kernels.choose import end_and_choose
from limbik.core.kernels.frames import new_pose
from limbik.core.kernels.layout import LEAST_FOUND, Body, Choice, Options, Plugs
from limbik.core.kernels.orient import orient_end
from limbik.core.kernels.rotation import copy_rows, norm, subtract, vector
from limbik.core.kernels.solve3d import (
    FAILED,
    lead,
    settle_pose,
    write_numbers,
    write_pose,
)
from limbik.core.rotation import Array


@entry
def solve_fully(
    body: Body,
    options: Options,
    choice: Choice,
    plugs: Plugs,
    goals: Array,
    fk: Array,
    memory: Array,
    chained: bool,
    angles: Array,
    positions: Array,
    rotations: Array,
    numbers: Array,
    trace: Array,
) -> int:
    """Solve many goals one after the other.

    Arguments and result as in `solve_goals`, with `choice` beside them; but goals may be (m, 6),
    then how they are turned, HPB [rad], or NaN.
    """
    pose = new_pose(body.offsets.shape[0])
    copy_rows(plugs.own, pose.own)
    kept = memory.copy()
    stages = 0
    for row in range(goals.shape[0]):
        if not chained:
            copy_rows(kept, memory)
        goal = vector(goals, row)
        led = lead(goal, body, options, plugs, fk, memory, pose, trace)
        failed, stages = led.failed, led.stages
        if led.onward and plugs.finish != 0:
            ended, stages = end_and_choose(
                led.pursued, body, options, choice, plugs, memory, pose, trace, stages
            )
            if not ended:
                failed = FAILED + 4
            pose.verdict[LEAST_FOUND] += norm(subtract(goal, led.pursued))
        if led.onward and choice.end_orientation > 0.0 and goals.shape[1] > 3:
            turn = (goals[row, 3], goals[row, 4], goals[row, 5])
            if not isnan(turn[0]):
                orient_end(turn, choice.end_orientation, body, pose)
        settle_pose(body, options, fk, memory, pose)
        write_numbers(goal, led, failed, options, pose, numbers[row])
        write_pose(pose, angles[row], positions[row], rotations[row])
    return stages
