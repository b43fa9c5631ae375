"""Cartesian trajectories: shapes, speeds, corners and orientations (003)."""
