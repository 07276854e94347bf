"""PEIS peers in Python: programs without ROS, and without any package but this one, in a network of Rubicon peers.

    from rubicon import Peer

    with Peer("robot", connect="tcp://127.0.0.1:8000") as robot:
        robot["position"] = "2 3"
        print(robot.get("kitchen.fan.state", owner="kitchen-pc"))
        robot.subscribe("devices.*.temperature", lambda x: print(x.owner, x.key, x.value))

Everything is in class Peer; see docs/python.md.
"""
from .errors import (BadValueError, ClosedError, NoSuchHostError, NoSuchTupleError, NotConnectedError, PeerError,
                     RefusedError, TimedOutError)
from .meta import Reference
from .peer import Host, Peer, Subscription
from .records import Tuple

__all__ = ["Peer", "Tuple", "Host", "Subscription", "Reference", "PeerError", "NotConnectedError", "NoSuchHostError",
           "NoSuchTupleError", "TimedOutError", "RefusedError", "BadValueError", "ClosedError"]
