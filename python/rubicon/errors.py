"""What peers and runs raise. Every exception of this package is a PeerError or a RunError."""


class PeerError(Exception):
    """A request to a peer has failed; the text gives the reason."""


class RunError(Exception):
    """A run could not be started, or has ended; the text gives the reason."""


class RequestError(RunError, ValueError):
    """The run does not do what was requested, and goes on."""


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
