"""Ecologies in code: dicts and lists to the text of a TOML file."""
from __future__ import annotations

import math
import re
from typing import Any, List, Mapping

from .errors import RequestError

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def _key(name: Any) -> str:
    if not isinstance(name, str):
        raise RequestError(f"{name!r}: a key is a text")
    return name if _BARE.fullmatch(name) else _text(name)


def _text(x: str) -> str:
    out = []
    for c in x:
        if c in '"\\':
            out.append("\\" + c)
        elif ord(c) < 32 or ord(c) == 127:
            out.append(f"\\u{ord(c):04x}")
        else:
            out.append(c)
    return '"' + "".join(out) + '"'


def _value(x: Any, place: str) -> str:
    if isinstance(x, bool):
        return "true" if x else "false"
    if isinstance(x, int):
        return str(x)
    if isinstance(x, float):
        if not math.isfinite(x):
            raise RequestError(f"{place}: {x} is no number of a file")
        return repr(x)
    if isinstance(x, str):
        return _text(x)
    if isinstance(x, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {_value(v, f'{place}.{k}')}" for k, v in x.items()) + " }"
    if isinstance(x, (list, tuple)):
        return "[" + ", ".join(_value(v, f"{place}[{i}]") for i, v in enumerate(x)) + "]"
    raise RequestError(f"{place}: {type(x).__name__} has no form in a file")


def _is_tables(x: Any) -> bool:
    return isinstance(x, (list, tuple)) and len(x) > 0 and all(isinstance(y, Mapping) for y in x)


def _add_table(out: List[str], names: List[str], table: Mapping) -> None:
    place = ".".join(names)
    inner = []
    for name, x in table.items():
        if isinstance(x, Mapping) or _is_tables(x):
            inner.append((name, x))
        else:
            out.append(f"{_key(name)} = {_value(x, f'{place}.{name}' if place else str(name))}")
    for name, x in inner:
        path = names + [_key(name)]
        for each in x if _is_tables(x) else [x]:
            out.append("")
            out.append(f"[[{'.'.join(path)}]]" if _is_tables(x) else f"[{'.'.join(path)}]")
            _add_table(out, path, each)


def to_toml(ecology: Mapping) -> str:
    """The text of a file that describes `ecology`: dicts are tables, lists of dicts arrays of tables.

    Raises RequestError, with the place, of what no file can hold.
    """
    out: List[str] = []
    _add_table(out, [], ecology)
    return "\n".join(out).lstrip("\n") + "\n"
