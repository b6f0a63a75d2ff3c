"""How long calls tell what they are doing."""

from __future__ import annotations

from typing import Callable, NamedTuple, Optional


class Event(NamedTuple):
    """One report of a long call.

    Attributes:
        kind: "begin", "advance" or "end" of a unit of work, "info" or "warning".
        text: the name of the unit of work, or the message.
        done: steps so far.
        total: steps in all, 0 where that is not known.
    """

    kind: str
    text: str
    done: int
    total: int


def teller(progress: Optional[Callable[[Event], None]]) -> Optional[Callable[[str, str, int, int], None]]:
    """What C++ calls."""
    if progress is None:
        return None
    listener = progress
    return lambda kind, text, done, total: listener(Event(kind, text, done, total))
