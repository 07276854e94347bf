"""What a peer raises. Every exception of this package is a PeerError."""


class PeerError(Exception):
    """A request to a peer has failed; the text gives the reason."""


class NotConnectedError(PeerError):
    """There is no link to any other peer."""


class NoSuchHostError(PeerError):
    """No reachable peer has that id or name, or it has gone."""


class NoSuchTupleError(PeerError, KeyError):
    """There is no such tuple, or it is not known here yet."""

    __str__ = Exception.__str__


class TimedOutError(PeerError):
    """The answer has not arrived in time."""


class RefusedError(PeerError):
    """The owner does not accept it, or a limit is reached."""


class BadValueError(PeerError, ValueError):
    """An argument cannot be a key, value, id, address or time."""


class ClosedError(PeerError):
    """The peer has been closed."""
