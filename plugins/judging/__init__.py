"""How natural a motion is, in numbers: one idea a file, put together in `catalogue`."""
