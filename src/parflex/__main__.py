"""`python -m parflex`."""

from parflex.app.cli import run

run()
