"""Pose goals: position and orientation of the end, by damped Newton steps within the limits (M-13)."""
