"""Exact derivatives of the models."""
