"""Arguments of a peer, and names and addresses of the computer."""
from __future__ import annotations

import getpass
import os
import socket
from typing import Optional, Tuple, Union

from . import wire
from .errors import BadValueError
from .wire import Address

Owner = Union[int, str]  # an id, or a name as `rubicon hosts` shows it


def check_name(name: str) -> str:
    if not isinstance(name, str) or not 0 < len(name) <= 30 or "@" in name or not name.isascii() or \
            not name.isprintable():
        raise BadValueError("the name of a peer has 1 to 30 ASCII characters, none of them @")
    return name


def check_id(id: int) -> int:
    if not isinstance(id, int) or isinstance(id, bool) or not 0 < id <= wire.ID_MAX:
        raise BadValueError(f"an id is 1 to {wire.ID_MAX}, not {id!r}")
    return id


def check_owner(owner: Owner) -> None:
    if not isinstance(owner, str):
        check_id(owner)


def check_times(expires: Optional[float], user_time: float) -> None:
    if expires is not None and not 0 < expires < 1 << 30:
        raise BadValueError("expires is a number of seconds from now")
    if not 0 <= user_time < 1 << 31:
        raise BadValueError("user_time is in seconds since 1970")


def user_name() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError, ImportError):
        return str(os.getuid())


def own_addresses(listener: Optional[socket.socket]) -> Tuple[Address, ...]:
    """For the host record: where links are accepted."""
    if listener is None:
        return ()
    host, port = listener.getsockname()
    if host != "0.0.0.0":
        return (Address("lo" if host.startswith("127.") else "net", host.startswith("127."), host, port),)
    found = [Address("lo", True, "127.0.0.1", port)]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("227.1.3.5", 10001))  # sends nothing, but selects the local address
            found.append(Address("net", False, probe.getsockname()[0], port))
        except OSError:
            pass
    return tuple(found)
