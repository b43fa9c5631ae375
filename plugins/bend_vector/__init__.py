"""Bend-vector modes: toward which side a limb bends."""
