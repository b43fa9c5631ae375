"""Compiled numeric code: scalars and small arrays in, arrays out, no Python objects."""
