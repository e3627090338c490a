"""The mechanics of the paper; it imports NumPy alone."""
