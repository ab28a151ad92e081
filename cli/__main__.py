"""`python -m tlismni.cli`."""

from . import main

main()
