"""Words that several findings share."""


def counted(number: int, thing: str) -> str:
    """Return a number with its noun, in the plural where it is not one."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def refused_messages(topic: str, refused: int, messages: int) -> str:
    """Say how many messages of a topic are left out for their numbers."""
    return (
        f"{topic}: {counted(refused, 'message')} of {messages} with a number that is not finite "
        "or that no robot reaches; left out"
    )
