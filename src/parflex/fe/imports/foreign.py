"""What other libraries say of a file, in few words."""

MOST = 100  # characters


def briefly(error: Exception) -> str:
    """The first line of an error's text, shortened."""
    first = next(iter(str(error).splitlines()), "")
    return first if len(first) <= MOST else first[: MOST - 1] + "…"
