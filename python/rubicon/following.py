"""Following what a meta tuple refers to."""
from __future__ import annotations

import time
from typing import Callable, List, Optional

from . import meta
from .errors import BadValueError, RefusedError
from .kernel import Kernel
from .records import Prototype, Tuple


class Follower:
    """Keeps a subscription of the tuple to which a meta tuple refers."""

    def __init__(self, kernel: Kernel, deliver: Callable[[Tuple], None], numbers: List[int]) -> None:
        self._kernel, self._deliver, self._numbers = kernel, deliver, numbers
        self._target: Optional[meta.Reference] = None
        self._number: Optional[int] = None

    def __call__(self, x: Tuple) -> None:
        target = None
        try:
            target = None if x.deleted else meta.read_reference(x)
        except BadValueError:
            self._kernel.space.counters["bad_meta_tuples"] += 1
        if target == self._target:
            return
        self._target = target
        if self._number is not None:
            self._numbers.remove(self._number)
            self._kernel.space.unsubscribe(self._number)
            self._number = None
        if target is not None:
            try:
                self._number = self._kernel.space.subscribe(Prototype(*target), self._deliver, time.monotonic())
            except RefusedError:
                self._target = None
                return
            self._numbers.append(self._number)
