"""Small motions about an equilibrium as a linear system: what makes it move, what is seen of it."""
