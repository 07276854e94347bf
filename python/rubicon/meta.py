"""Meta tuples: tuples whose value names another one (docs/peis-wire.md 17)."""
from __future__ import annotations

import re
from typing import NamedTuple, Optional

from . import keys
from .errors import BadValueError
from .records import META_MIMETYPE, Tuple
from .wire import EVERYBODY, ID_MAX

_FORM = re.compile(r"\s*\(\s*META\s+(-?\d{1,10})\s+([^\s)]+)\s*\)?\s*\Z")


class Reference(NamedTuple):
    """The tuple that a meta tuple refers to."""
    owner: int
    key: str


def format_reference(x: Optional[Reference]) -> str:
    return f"(META {x.owner} {x.key})" if x else "(META -1 NULL)"


def parse_reference(text: str) -> Optional[Reference]:
    """None if it refers to none; BadValueError if it is no reference."""
    found = _FORM.match(text)
    if not found:
        raise BadValueError(f"{text[:40]!r} is no reference to a tuple")
    owner, key = int(found[1]), found[2]
    if owner == EVERYBODY:
        return None
    if not 0 < owner <= ID_MAX:
        raise BadValueError(f"{owner} is no id of a peer")
    return Reference(owner, keys.check(key))


def read_reference(x: Tuple) -> Optional[Reference]:
    if x.mimetype != META_MIMETYPE:
        raise BadValueError(f"{x.key} of {x.owner} is no meta tuple")
    return parse_reference(x.text)
