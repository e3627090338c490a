"""Free bodies, their bases and the errors of these."""
