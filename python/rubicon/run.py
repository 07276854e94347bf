"""Runs of ecologies that a program steers: `Run` starts the binary and decides when time goes on.

All times are in seconds. docs/steering.md is about the same, and about the protocol below.
"""
from __future__ import annotations

import contextlib
import json
import os
import select
import shutil
import socket
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, TypeVar, Union

from .errors import RequestError, RunError
from .toml_text import to_toml

__all__ = ["Run", "Step", "Event", "Write", "map_runs"]

PROTOCOL = 1
_READ_MAX = 1 << 16
_T = TypeVar("_T")
_R = TypeVar("_R")


class Event(NamedTuple):
    """Something that the run has noted: `at` [s since the begin of the run], `who` it is about, and `what` happened."""
    at: float
    who: str
    what: str


class Write(NamedTuple):
    """A component has set or deleted a tuple.

    `at` [s since the begin of the run], the name of its `owner`, its `key`, and its `value`; None: it was deleted.
    """
    at: float
    owner: str
    key: str
    value: Optional[str]


class Step(NamedTuple):
    """What has happened in a step.

    `now` is the time [s since the begin of the run], `over` whether the run has come to its length or its end. `events`
    and `tuples` are those that were subscribed to; `missed` is how many more there were, before these, than an answer
    holds.
    """
    now: float
    over: bool
    events: List[Event]
    tuples: List[Write]
    missed: int


def _step_of(answer: Mapping[str, Any]) -> Step:
    return Step(answer["now"], answer.get("over", False), [Event(*x) for x in answer.get("events", ())],
                [Write(*x) for x in answer.get("tuples", ())], answer.get("missed", 0))


class Run:
    """A run of an ecology in virtual time, which stands still between the calls.

        with Run("home.toml", seed=7) as run:
            run.step(60)
            print(run.get("kitchen-pc", "devices.stove.temperature"))
            run.fault("crash mote kitchen/stove for 10s")
            print(run.finish()["violations"])

    `ecology` is a file, or a dict with the content of one (lists of dicts are its arrays of tables); files that a dict
    names are looked for in the working directory. `seed` and `length` [s] replace those of the file. `binary` is the
    program, which is otherwise `$RUBICON` or found on the PATH; `options` are further ones of `rubicon run`.

    `name`, `seed`, `length` [s], `peers` and `mote_names` are those of the run, `now` is its time [s since its begin].

    A request that the run refuses raises RequestError, and the run goes on. RunError means that there is no run, or no
    longer one, and gives the reason: a file with mistakes, a binary that has ended.

    The process ends with the block, with close(), with the object, and with the Python program, however that ends.
    Not for several threads at once; each thread may have runs of its own, and AsyncRun is for asyncio.
    """

    def __init__(self, ecology: Union[str, os.PathLike[str], Mapping[str, Any]], *, seed: Optional[int] = None,
                 length: Optional[float] = None, binary: Optional[str] = None, options: Sequence[str] = (),
                 threads: int = 1) -> None:
        """Starts the binary, with so many threads. RunError: it is not there, or the file has mistakes."""
        program = binary or os.environ.get("RUBICON") or shutil.which("rubicon")
        if program is None:
            raise RunError("there is no program rubicon on the PATH")
        self._socket: Optional[socket.socket] = None
        self._process: Optional[subprocess.Popen[bytes]] = None
        self._received = b""
        self._folder = tempfile.mkdtemp(prefix="rubicon-")
        try:
            self._start(program, ecology, seed, length, list(options), threads)
        except BaseException:
            self.close()
            raise

    def _start(self, program: str, ecology: Any, seed: Optional[int], length: Optional[float], options: List[str],
               threads: int) -> None:
        if isinstance(ecology, Mapping):
            file = os.path.join(self._folder, "ecology.toml")
            with open(file, "w", encoding="utf-8") as out:
                out.write(to_toml(ecology))
        else:
            file = os.fspath(ecology)
        path = os.path.join(self._folder, "steer")
        words = [program, "run", file, "--mode", "virtual", "--threads", str(threads), "--json", "--steer", path]
        if seed is not None:
            words += ["--seed", str(seed)]
        if length is not None:
            words += ["--for", f"{round(length * 1000)}ms"]
        self._errors = os.path.join(self._folder, "errors")
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener, open(self._errors, "wb") as errors:
            listener.bind(path)
            listener.listen(1)
            self._process = subprocess.Popen(words + options, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                             stderr=errors)
            while not select.select([listener], [], [], 0.05)[0]:
                if self._process.poll() is not None:
                    raise RunError(self._complaint())
            self._socket = listener.accept()[0]
        hello = self._receive()
        if hello.get("rubicon") != PROTOCOL:
            raise RunError(f"{program} speaks another protocol")
        self.name: str = hello["ecology"]
        self.seed: int = hello["seed"]
        self.length: float = hello["length"]  # [s]
        self.peers: List[str] = hello["peers"]
        self.mote_names: List[str] = hello["motes"]
        self.now = 0.0  # [s] since the begin of the run

    # -- the protocol

    def _complaint(self) -> str:
        with contextlib.suppress(OSError), open(self._errors, "rb") as errors:
            text = errors.read(1 << 16).decode("utf-8", "replace").strip()
            if text:
                return text
        status = None if self._process is None else self._process.poll()
        return "the run has ended" + (f" by signal {-status}" if status is not None and status < 0 else "")

    def _broken(self) -> RunError:
        why = self._complaint()
        self.close()
        return RunError(why)

    def _receive(self) -> Any:
        assert self._socket is not None
        pieces = [self._received]
        while b"\n" not in pieces[-1]:
            try:
                piece = self._socket.recv(_READ_MAX)
            except OSError:
                piece = b""
            if not piece:
                raise self._broken()
            pieces.append(piece)
        line, _, self._received = b"".join(pieces).partition(b"\n")
        return json.loads(line)

    def _ask(self, request: Any) -> Any:
        if self._socket is None:
            raise RunError("the run is closed")
        try:
            self._socket.sendall(json.dumps(request).encode() + b"\n")
        except OSError:
            raise self._broken() from None
        return self._receive()

    def _do(self, what: str, **members: Any) -> Dict[str, Any]:
        return self._checked(self._ask({"do": what, **members}))

    def _checked(self, answer: Dict[str, Any]) -> Dict[str, Any]:
        if not answer["ok"]:
            raise RequestError(answer["why"])
        self.now = answer.get("now", self.now)
        return answer

    def batch(self, requests: Sequence[Mapping[str, Any]]) -> List[Dict[str, Any]]:
        """Sends up to 4096 requests of the protocol (docs/steering.md) at once and returns their answers as they are.

        Thousands of short steps or reads cost one exchange.
        """
        answers = self._ask(list(requests))
        if isinstance(answers, dict):
            raise RequestError(answers["why"])
        for each in answers:
            self.now = each.get("now", self.now)
        return answers

    # -- time

    def step(self, length: Optional[float] = None, *, until: Union[float, Callable[[Run], Any], None] = None,
             every: float = 1.0, limit: Optional[float] = None) -> Step:
        """Lets time go on: for `length` [s], or until a time [s since the begin], or until a condition holds.

        A condition is called with the run after every `every` [s], for `limit` [s] at most (to the end of the run
        without it). Events and tuples of all its steps are in the result.
        """
        if callable(until):
            return self._step_until(until, every, limit)
        if (length is None) == (until is None):
            raise TypeError("step() takes either a length or until")
        return _step_of(self._do("step", **({"for": length} if until is None else {"until": until})))

    def _step_until(self, done: Callable[[Run], Any], every: float, limit: Optional[float]) -> Step:
        if not every > 0:
            raise ValueError("every must be above 0 s")
        events: List[Event] = []
        tuples: List[Write] = []
        latest = self.length if limit is None else min(self.length, self.now + limit)
        missed, over = 0, self.now >= self.length
        while not done(self) and not over and self.now < latest:
            x = self.step(until=min(self.now + every, latest))
            events += x.events
            tuples += x.tuples
            missed, over = missed + x.missed, x.over
        return Step(self.now, over, events, tuples, missed)

    # -- what is there

    def get(self, peer: str, key: str, owner: Optional[str] = None) -> Optional[str]:
        """The tuple as `peer` has it: its own one, or its copy of `owner`'s. None: it has none, or does not run."""
        return self._do("get", peer=peer, key=key, **({} if owner is None else {"owner": owner}))["value"]

    def subscribe(self, pattern: str = "", owner: Optional[str] = None) -> None:
        """Steps return the writes of tuples that match; `*` stands for one part of a key, the empty pattern for all."""
        self._do("tuples", pattern=pattern, **({} if owner is None else {"owner": owner}))

    def subscribe_events(self) -> None:
        """Steps return the events of the run: who joined, what failed."""
        self._do("events")

    def motes(self) -> Dict[str, Dict[str, Any]]:
        """All motes by name, a dict each.

        `alive`, `flat` (its battery), `joined`, `radio_on`; `used_mah` and `battery_mah` [mAh], None: without limit; its
        `parent` and `hops` in the tree; `queued`, `originated`, `forwarded` packets; `delivery` [0..1] of its reliable
        messages, `etx` and `signal_dbm` [dBm] of its parent, None: not known. `island` and `mote` are its address.
        """
        return {x["name"]: x for x in self._do("motes")["motes"]}

    def report(self) -> Dict[str, Any]:
        """The report so far, as `rubicon run --json` prints it. All actors are asked for it: that changes the trace."""
        return self._do("report")["report"]

    # -- actions

    def set(self, peer: str, key: str, value: str) -> None:
        """Sets an own tuple of a peer, as one of its components would, as the next step begins."""
        self._do("set", peer=peer, key=key, value=value)

    def fault(self, words: str) -> None:
        """Causes a fault or a change now, in the words of `rubicon fault`.

        `kill peer robot for 10s`, `crash mote kitchen/stove`, `rate mote kitchen/stove period 5s`.
        """
        self._do("fault", words=words)

    def send(self, mote: str, destination: str, octets: Union[bytes, str], *, am_type: int = 10,
             reliable: bool = True) -> int:
        """Sends a message as a program of a mote does, to a mote or a peer, as the next step begins.

        `octets` are 256 at most, or a text as UTF-8; `am_type` is from 0 to 255. Returns the number of the message,
        with which events of the mote name its outcome: `message 1 acknowledged`, `message 1 not acknowledged`,
        `message 1 refused`. Of one that is not `reliable`, only the last is known.
        """
        text = (octets.encode() if isinstance(octets, str) else bytes(octets)).hex()
        return self._do("send", mote=mote, to=destination, octets=text, am_type=am_type, reliable=reliable)["number"]

    def record(self) -> str:
        """What was done so far: the lines of a file LINES with which `rubicon run FILE --steer LINES` does it again."""
        return self._do("record")["lines"]

    def to_toml_tables(self) -> str:
        """The same as [[fault]] and [[change]] tables, to append to the file: then it does so without --steer.

        Tuples that were set and messages that were sent have no such table: they are comments.
        """
        return self._do("tables")["tables"]

    # -- the end

    def finish(self) -> Dict[str, Any]:
        """Runs it to its end and returns the report, as `rubicon run --json` prints it. The run is closed then."""
        report = self._do("finish")["report"]
        self.close()
        return report

    def _interrupt(self) -> None:
        """Lets a call of another thread end at once, with RunError."""
        connection = self._socket
        if connection is not None:
            with contextlib.suppress(OSError):
                connection.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """Ends the process, wherever the run is."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None
        if self._process is not None:
            try:
                self._process.wait(2.0)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
            self._process = None
        shutil.rmtree(self._folder, ignore_errors=True)

    def __enter__(self) -> Run:
        """The run itself."""
        return self

    def __exit__(self, *_: Any) -> None:
        """As close()."""
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_process", None) is not None:
            self.close()


def map_runs(function: Callable[[_T], _R], settings: Iterable[_T], at_once: Optional[int] = None) -> List[_R]:
    """Calls `function` with each of the settings, as many at once as there are processors, and returns the results.

    The function makes a Run: that is a process of its own, so that runs do not wait for each other.
    """
    with ThreadPoolExecutor(at_once or os.cpu_count() or 1) as pool:
        return list(pool.map(function, settings))
