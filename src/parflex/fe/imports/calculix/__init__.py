"""CalculiX."""
