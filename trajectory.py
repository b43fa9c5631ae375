"""Cartesian trajectories: key points and moves to poses in time, and to joint motion (003).

```python
from limbik.trajectory import Blend, KeyPoint, Limits, Line, plan

start, corner, end = (KeyPoint.from_quaternion(p, (1, 0, 0, 0)) for p in points)
trajectory = plan(start, [Line(corner), Blend(0.05), Line(end)], Limits(0.5, 1.0))
samples = trajectory.sample(dt=0.01)
motion = joint_motion(samples, Solver(chain))
```

Needs the extra `limbik[trajectory]` (scipy).
"""

from limbik.plugins.paths.joints import Failure, JointMotion, joint_motion
from limbik.plugins.paths.keypoint import KeyPoint
from limbik.plugins.paths.moves import (
    Arc,
    ArcAbout,
    Blend,
    Limits,
    Line,
    Overlap,
    Spline,
    Stop,
    Turn,
)
from limbik.plugins.paths.overlap import OverlapReport, overlap_samples
from limbik.plugins.paths.program import Stretch, Trajectory, plan
from limbik.plugins.paths.samples import Samples

__all__ = [
    "Arc",
    "ArcAbout",
    "Blend",
    "Failure",
    "JointMotion",
    "KeyPoint",
    "Limits",
    "Line",
    "Overlap",
    "OverlapReport",
    "Samples",
    "Spline",
    "Stop",
    "Stretch",
    "Trajectory",
    "Turn",
    "joint_motion",
    "overlap_samples",
    "plan",
]
