"""PEIS peers in Python, and runs of ecologies that Python steers: with no package but this one.

    from rubicon import Peer

    with Peer("robot", connect="tcp://127.0.0.1:8000") as robot:
        robot["position"] = "2 3"
        print(robot.get("kitchen.fan.state", owner="kitchen-pc"))
        robot.subscribe("devices.*.temperature", lambda x: print(x.owner, x.key, x.value))

    from rubicon import Run

    with Run("home.toml", seed=7) as run:
        run.step(60)
        print(run.get("kitchen-pc", "devices.stove.temperature"), run.finish()["violations"])

Class Peer is described in docs/python.md, classes Run and AsyncRun in docs/steering.md.
"""
from .async_run import AsyncRun
from .errors import (BadValueError, ClosedError, NoSuchHostError, NoSuchTupleError, NotConnectedError, PeerError,
                     RefusedError, RequestError, RunError, TimedOutError)
from .meta import Reference
from .peer import Host, Peer, Subscription
from .records import Tuple
from .run import Event, Run, Step, Write, map_runs
from .toml_text import to_toml

__all__ = ["Peer", "Tuple", "Host", "Subscription", "Reference", "PeerError", "NotConnectedError", "NoSuchHostError",
           "NoSuchTupleError", "TimedOutError", "RefusedError", "BadValueError", "ClosedError", "Run", "AsyncRun",
           "Step", "Event", "Write", "map_runs", "to_toml", "RunError", "RequestError"]
