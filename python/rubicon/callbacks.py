"""Runs the functions of subscribers, one after the other, on a thread of their own or in poll()."""
from __future__ import annotations

import logging
import threading
import time
from collections import deque
from typing import Any, Callable, Deque, Optional, Tuple

WAITING_MAX = 4096  # calls

log = logging.getLogger("rubicon")

Call = Tuple[Callable[[Any], None], Any]


class CallbackQueue:
    """Calls in the order of arrival. If too many wait, the oldest is dropped and counted."""

    def __init__(self, threaded: bool) -> None:
        self._calls: Deque[Call] = deque()
        self._changed = threading.Condition()
        self._ended = False
        self.dropped = 0
        self.thread: Optional[threading.Thread] = None
        if threaded:
            self.thread = threading.Thread(target=self._run, name="rubicon-callbacks", daemon=True)
            self.thread.start()

    def add(self, function: Callable[[Any], None], argument: Any) -> None:
        with self._changed:
            if len(self._calls) >= WAITING_MAX:
                self._calls.popleft()
                self.dropped += 1
            self._calls.append((function, argument))
            self._changed.notify()

    def end(self) -> None:
        with self._changed:
            self._ended = True
            self._changed.notify_all()

    def poll(self, timeout: float) -> int:
        """Runs what waits, or what arrives first within timeout seconds. How many calls were made."""
        end, made = time.monotonic() + timeout, 0
        with self._changed:
            while not self._calls and not self._ended:
                left = end - time.monotonic()
                if left <= 0:
                    break
                self._changed.wait(left)
            calls = list(self._calls)
            self._calls.clear()
        for function, argument in calls:
            function(argument)
            made += 1
        return made

    def _run(self) -> None:
        while True:
            with self._changed:
                while not self._calls and not self._ended:
                    self._changed.wait()
                if self._ended:
                    return
                function, argument = self._calls.popleft()
            try:
                function(argument)
            except Exception:  # pylint: disable=broad-except
                log.exception("a callback has failed")
