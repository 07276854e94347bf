"""What the tests of the Python peer share: kernels in one process and virtual time, and the binary."""
import os
import pathlib
import random
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
sys.dont_write_bytecode = True

from rubicon.kernel import Kernel  # noqa: E402
from rubicon.wire import HostRecord  # noqa: E402

WAIT_S = 10.0


def golden(name):
    """Octets of a capture: hexadecimal, what follows # is comment."""
    text = (ROOT / "tests/golden/peis" / name).read_text()
    return bytes.fromhex("".join(line.split("#")[0] for line in text.splitlines()))


def free_port():
    with socket.socket() as free:  # a moment ago
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


def eventually(condition, timeout=WAIT_S):
    """Waits until it holds; False if it does not in time."""
    end = time.monotonic() + timeout
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


class VirtualNetwork:
    """Kernels with links between them, in steps of 10 ms of virtual time."""

    def __init__(self, *ids, loss=0.0):
        self.now = 100.0
        self.rng = random.Random(1)
        self.loss = loss
        self.kernels = {id: self.kernel(id) for id in ids}
        self.cables = {}  # link of a kernel: the other end
        self.next = 1

    def kernel(self, id):
        record = HostRecord(id, self.rng.randrange(1, 1 << 30), "host", f"peer{id}@host!1", (), id)
        return Kernel(record, "rubicon", "user", 1e9, self.now, random.Random(self.rng.random()))

    def connect(self, a, b):
        """Returns the number of the link, the same at both ends."""
        number, self.next = self.next, self.next + 1
        self.cables[a, number], self.cables[b, number] = b, a
        self.kernels[b].overlay.link_opened(number, False, "127.0.0.1:1", self.now)
        self.kernels[a].overlay.link_opened(number, True, "127.0.0.1:2", self.now)
        return number

    def cut(self, number):
        for a, link in [x for x in self.cables if x[1] == number]:
            del self.cables[a, link]
            self.kernels[a].overlay.link_closed(number, self.now)

    def run(self, seconds):
        end = self.now + seconds
        while self.now < end:
            self.now += 0.01
            for id, kernel in self.kernels.items():
                kernel.on_time(self.now)
                for notice in kernel.take_notices():
                    if not notice.up:
                        self.cut(notice.link)
            for (a, number), b in list(self.cables.items()):
                self.carry(a, b, number)

    def carry(self, a, b, number):
        link = self.kernels[a].overlay.links.get(number)
        while link is not None and link.waiting:
            octets = link.take_output(1)  # a package
            if len(octets) < 76 or self.rng.random() >= self.loss:
                self.kernels[b].link_octets(number, octets, self.now)


FILE = """
[ecology]
name = "flat"
mode = "wall"
duration = "10min"

[[peer]]
id = 30
name = "pc"
tcp = {{ port = {port} }}
{more}
"""


class Binary:
    """`rubicon run` of one peer that listens on loopback: id 30, name pc."""

    def __init__(self, rubicon, port=None, more=""):
        self.port = port or free_port()
        self.rubicon = rubicon
        self.folder = tempfile.TemporaryDirectory()
        file = pathlib.Path(self.folder.name, "flat.toml")
        file.write_text(FILE.format(port=self.port, more=more))
        self.environment = dict(os.environ, XDG_STATE_HOME=self.folder.name)
        self.process = subprocess.Popen([rubicon, "run", str(file), "--log", "off"], stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL, env=self.environment)
        if not eventually(self.listens, 60):
            self.kill()
            raise RuntimeError("the binary does not listen")

    @property
    def address(self):
        return f"tcp://127.0.0.1:{self.port}"

    def listens(self):
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", self.port)) == 0

    def tuples(self, *words):
        """`rubicon tuples WORDS`: what it prints."""
        done = subprocess.run([self.rubicon, "tuples", *words, "--connect", f"127.0.0.1:{self.port}"], timeout=60,
                              capture_output=True, text=True, env=self.environment, check=False)
        if done.returncode:
            raise AssertionError(f"{words}: {done.stderr}")
        return done.stdout

    def kill(self):
        self.process.kill()
        self.process.wait()

    def end(self):
        if self.process.poll() is None:
            self.kill()
        self.folder.cleanup()
