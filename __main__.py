"""`python -m limbik`."""

from limbik.cli import main

main()
