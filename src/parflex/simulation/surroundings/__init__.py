"""The surroundings of a robot in a simulation: a floor that moves, springs whose rest moves."""
