"""Planar chains of source 001: CCD and FABRIK with and without limits."""
