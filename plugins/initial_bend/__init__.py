"""Initial-bend methods: how the bones lie before CCD starts."""
