"""Finishes: what ends a solve at the goal after CCD, or proves why not."""
