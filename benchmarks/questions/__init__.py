"""One question per file; `ALL` is the order in which they are asked, agreement first."""

from benchmarks.questions import (
    agreement,
    batch,
    cold_start,
    derivatives,
    designs,
    equilibria,
    flexible_legs,
    legs,
    models,
    precision,
    scaling,
    simulation,
    viewer,
)

ALL = {
    "agreement": agreement.ask,
    "models": models.ask,
    "flexible-legs": flexible_legs.ask,
    "batch": batch.ask,
    "designs": designs.ask,
    "equilibria": equilibria.ask,
    "derivatives": derivatives.ask,
    "legs": legs.ask,
    "scaling": scaling.ask,
    "simulation": simulation.ask,
    "precision": precision.ask,
    "cold-start": cold_start.ask,
    "viewer": viewer.ask,
}
