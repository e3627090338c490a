"""Materials that links and plates are made of: Young's modulus Pa, Poisson's ratio, density kg/m³."""

STEEL = {"young": 2.1e11, "poisson": 0.3, "density": 7850.0}
ALUMINIUM = {"young": 7.0e10, "poisson": 0.33, "density": 2700.0}
CARBON = {"young": 6.0e10, "poisson": 0.3, "density": 1550.0}  # a quasi-isotropic laminate
