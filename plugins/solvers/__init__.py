"""Whole solvers: each brings the closed form or the search of one kind of chain."""
