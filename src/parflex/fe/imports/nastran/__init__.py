"""Nastran."""
