"""`python -m parflex`."""

from parflex.cli import run

run()
