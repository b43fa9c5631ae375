"""FABRIK in three dimensions, with the limits of limbik's joints (001; G-05)."""
