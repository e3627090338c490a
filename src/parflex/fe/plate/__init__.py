"""Thin plates."""
