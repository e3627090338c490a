"""What the paper does; it imports NumPy alone."""
