"""One question per file; `ALL` is the order in which they are asked, agreement first."""

from benchmarks.questions import agreement, models

ALL = {"agreement": agreement.ask, "models": models.ask}
