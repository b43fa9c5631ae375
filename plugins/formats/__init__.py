"""File formats: robots and motion clips in, motion out; one format a module."""
