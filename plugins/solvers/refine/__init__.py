"""Pose goals: position and orientation of the end, within the limits (M-13)."""
