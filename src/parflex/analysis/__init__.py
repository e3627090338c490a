"""What is asked of a robot besides its motion."""
