"""`python -m parflex`."""

from parflex.app.start import run

run()
