"""Analyses of a robot besides its motion."""
