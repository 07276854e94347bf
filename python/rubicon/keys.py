"""Keys of tuples: parts between dots, `*` for any one part (docs/peis-wire.md 15.7)."""
from __future__ import annotations

from .errors import BadValueError

PARTS_MAX = 7
OCTETS_MAX = 127

_UPPER = {c: c + 32 for c in range(ord("A"), ord("Z") + 1)}


def fold(text: str) -> str:
    """Without case of the 26 letters: equal keys become the same text."""
    return text.translate(_UPPER)


def check(text: str, pattern: bool = False) -> str:
    """The key itself, or BadValueError. Only patterns may have wildcards or be empty, which matches all."""
    if not isinstance(text, str):
        raise BadValueError(f"a key is a string, not {type(text).__name__}")
    try:
        octets = text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:
        raise BadValueError(f"the key {text!r} is no text") from None
    if len(octets) > OCTETS_MAX:
        raise BadValueError(f"the key {text[:20]!r}... has more than {OCTETS_MAX} octets")
    parts = text.split(".")
    if len(parts) > PARTS_MAX:
        raise BadValueError(f"the key {text!r} has more than {PARTS_MAX} parts")
    if "\0" in text or any("*" in part and part != "*" for part in parts):
        raise BadValueError(f"the key {text!r} has a NUL, or a * beside other characters")
    if not pattern and is_pattern(text):
        raise BadValueError(f"the key {text!r} has wildcards" if text else "the key is empty")
    return text


def is_pattern(text: str) -> bool:
    return not text or "*" in text.split(".")


def is_reserved(text: str) -> bool:
    """Of the kernel itself, which nobody else writes."""
    return fold(text).split(".", 1)[0] == "kernel"


def from_wire(text: str) -> str:
    """What is behind the seventh part is dropped."""
    return ".".join(text.split(".")[:PARTS_MAX])


def matches(pattern: str, key: str) -> bool:
    """Does the pattern cover the key? `a.*` does not cover `a.b.c`."""
    if not pattern:
        return True
    wanted, given = fold(pattern).split("."), fold(key).split(".")
    return len(wanted) == len(given) and all(w in ("*", g) for w, g in zip(wanted, given))
