"""The report: a simulation and how far it can be trusted, in one HTML file for others to read."""

from parflex.views.report.report import report_of

__all__ = ["report_of"]
