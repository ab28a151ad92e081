"""Words for messages."""


def an(noun: str) -> str:
    """The noun, a name of a class say, with its indefinite article."""
    return f"{'an' if noun[:1] in 'AEIOaeio' else 'a'} {noun}"
