"""Words that several findings share."""


def counted(number: int, thing: str) -> str:
    """Return a number with its noun, in the plural where it is not one."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"
