"""Files spoilt in all the ways that disks, mail and editors have."""

import numpy as np


def spoilt(data: bytes, rng: np.random.Generator) -> bytes:
    """A byte flipped, the end lost, a stretch overwritten, taken out, or put in twice."""
    out = bytearray(data)
    at, length = int(rng.integers(len(out))), int(rng.integers(1, 64))
    match rng.integers(5):
        case 0:
            out[at] ^= 1 + int(rng.integers(255))
        case 1:
            del out[at:]
        case 2:
            out[at : at + length] = rng.bytes(length)
        case 3:
            del out[at : at + length]
        case _:
            out[at:at] = out[at : at + length]
    return bytes(out)
