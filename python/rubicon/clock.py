"""The network's common time (docs/peis-wire.md 12)."""
from __future__ import annotations

from typing import Optional

from . import wire

PERIOD_S = 2.0
QUIET_S = 7.0  # after that of a master, or of a peer with a higher id
DEAD_BAND_S = 0.5  # of peers without the mark
AGREEMENT_S = 0.0005
TIME_MAX = 1 << 33  # seconds since 1970: what is beyond is no time


class NetworkClock:
    """Never a master: follows masters, and whoever is ahead. `now`: seconds of a clock that never goes back."""

    def __init__(self, self_id: int, offset: float, now: float) -> None:
        self._self, self._offset = self_id, offset
        self.next = now + PERIOD_S

    def at(self, now: float) -> float:
        """Network time, in seconds since 1970."""
        return now + self._offset

    def on_message(self, octets: bytes, source: int, marked: bool, last_link: float, now: float) -> None:
        """last_link: seconds that the last link took. Raises wire.WireError."""
        time, master, in_flight = wire.decode_clock(octets, self.at(now))
        if not 0 <= time < TIME_MAX:
            raise wire.WireError("bad time")
        delta = time + (in_flight + last_link if marked else 0.0) - self.at(now)
        band = 0.0 if marked else DEAD_BAND_S
        if delta > band or (master and delta < -band):
            self._offset += delta
        if master or (source > self._self and delta > -(AGREEMENT_S if marked else DEAD_BAND_S)):
            self.next = now + QUIET_S

    def on_time(self, now: float) -> Optional[bytes]:
        """What is to be broadcast."""
        if now < self.next:
            return None
        self.next = now + PERIOD_S
        return wire.encode_clock(self.at(now))
