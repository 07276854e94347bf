#!/usr/bin/env python3
"""The Python peer in one network with the binary, on loopback and in wall time.
usage: peer_test RUBICON"""
import os
import signal
import socket
import subprocess
import sys
import textwrap
import threading
import time
import unittest

from support import ROOT, Binary, eventually, free_port

from rubicon import (BadValueError, ClosedError, NoSuchHostError, NoSuchTupleError, NotConnectedError, Peer, PeerError,
                     RefusedError)
from rubicon.wire import encode_connect

RUBICON = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else ""
PC = 30


class WithBinary(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.binary = Binary(RUBICON)

    @classmethod
    def tearDownClass(cls):
        cls.binary.end()

    def peer(self, name, **how):
        peer = Peer(name, connect=self.binary.address, **how)
        self.addCleanup(peer.close)
        return peer


class ValuesTest(WithBinary):
    def test_the_binary_is_a_host(self):
        robot = self.peer("robot")
        self.assertEqual(robot.wait_for_host("PC"), PC)
        host = robot.hosts()[0]
        self.assertEqual((host.id, host.name, host.linked, host.hops), (PC, "pc", True, 1))
        self.assertTrue(robot.connected)
        self.assertAlmostEqual(robot.time(), time.time(), delta=5)

    def test_tuples_of_the_binary_are_read_and_written(self):
        robot = self.peer("robot")
        self.assertEqual(robot.get("kernel.name", owner="pc"), "pc")
        robot.set("kitchen.fan.state", "on", owner=PC)
        self.assertEqual(robot.get("Kitchen.Fan.State", owner=PC), "on")
        robot.append("kitchen.fan.state", ", fast", owner=PC)
        self.assertTrue(eventually(lambda: robot.get("kitchen.fan.state", PC) == "on, fast"))
        x = robot.get_tuple("kitchen.fan.state", PC)
        self.assertEqual((x.owner, x.creator, x.mimetype), (PC, robot.id, "text/plain"))
        self.assertIn("on, fast", self.binary.tuples("get", "kitchen.fan.state", "--owner", "pc"))
        robot.delete("kitchen.fan.state", owner=PC)
        self.assertTrue(eventually(lambda: not robot.tuples("kitchen.fan.state")))

    def test_own_tuples_are_read_and_written_by_the_binary(self):
        robot = self.peer("mower")
        robot["position"] = "2 3"
        self.assertEqual(self.binary.tuples("get", "position", "--owner", "mower").strip(), "2 3")
        got = []
        robot.subscribe("goal", got.append)
        self.binary.tuples("set", "goal", "dock", "--owner", str(robot.id))
        self.assertTrue(eventually(lambda: "goal" in robot))
        self.assertEqual(robot["goal"], "dock")
        self.binary.tuples("append", "goal", " 2", "--owner", str(robot.id))
        self.assertTrue(eventually(lambda: robot["goal"] == "dock 2"))
        self.binary.tuples("delete", "goal", "--owner", str(robot.id))
        self.assertTrue(eventually(lambda: len(got) == 3))
        self.assertEqual([(x.text, x.deleted) for x in got], [("dock", False), ("dock 2", False), ("dock 2", True)])
        self.assertNotEqual(got[0].creator, robot.id)
        del robot["position"]
        self.assertNotIn("position", robot)
        self.assertRaises(NoSuchTupleError, lambda: robot["position"])

    def test_a_megabyte_both_ways(self):
        robot = self.peer("robot")
        octets = bytes(range(256)) * 4096
        robot.set("big", octets, owner=PC, timeout=30)
        self.assertEqual(robot.get("big", PC, timeout=30), octets)
        robot.delete("big", PC)
        robot["long"] = "0123456789" * 100_000
        self.assertEqual(self.binary.tuples("get", "long", "--owner", str(robot.id)).strip(), robot["long"])

    def test_subscribers_get_the_present_value_and_each_change(self):
        robot, got = self.peer("robot"), []
        robot.set("devices.a.temperature", "20", PC)
        subscription = robot.subscribe("devices.*.temperature", got.append, PC)
        self.assertTrue(eventually(lambda: len(got) == 1))
        for value in range(21, 25):
            robot.set("devices.a.temperature", value, PC)
        self.assertTrue(eventually(lambda: len(got) == 5))
        self.assertEqual([x.value for x in got], ["20", "21", "22", "23", "24"])
        subscription.cancel()
        robot.set("devices.a.temperature", "25", PC)
        robot.delete("devices.a.temperature", PC)
        self.assertEqual(len(got), 5)

    def test_types_and_expiry(self):
        robot, got = self.peer("robot"), []
        robot.subscribe("image", got.append, PC, mimetype="image/png")
        robot.set("image", b"1", PC)
        robot.set("image", b"\x89PNG", PC, mimetype="image/png", expires=1.5, user_time=12.5)
        self.assertTrue(eventually(lambda: len(got) == 2, 6))
        self.assertEqual([(x.value, x.deleted) for x in got], [(b"\x89PNG", False), (b"\x89PNG", True)])
        self.assertEqual(got[0].user_time, (12, 500000))

    def test_meta_tuples(self):
        robot, got = self.peer("robot"), []
        robot.set("switch.a", "on", PC)
        robot.set("switch.b", "off", PC)
        robot.set_meta("mi-switch", None)
        self.assertIsNone(robot.get_meta("mi-switch"))
        self.assertRaises(NoSuchTupleError, robot.get_through, "mi-switch")
        subscription = robot.subscribe_through("mi-switch", got.append)
        robot.set_meta("mi-switch", PC, "switch.a")
        self.assertEqual(robot.get_meta("mi-switch"), (PC, "switch.a"))
        self.assertEqual(robot.get_through("mi-switch"), "on")
        self.assertTrue(eventually(lambda: [x.text for x in got] == ["on"]))
        robot.set_meta("mi-switch", "pc", "switch.b")
        self.assertTrue(eventually(lambda: [x.text for x in got] == ["on", "off"]))
        robot.set_through("mi-switch", "dim")
        self.assertTrue(eventually(lambda: [x.text for x in got] == ["on", "off", "dim"]))
        subscription.cancel()
        robot["switch"] = "no reference"
        self.assertRaises(BadValueError, robot.get_meta, "switch")

    def test_calls_from_many_threads(self):
        robot, errors = self.peer("robot"), []

        def work(number):
            try:
                for i in range(20):
                    robot.set(f"work.{number}", i, PC)
                    robot[f"own.{number}"] = i
                assert robot.get(f"work.{number}", PC) is not None
            except Exception as error:  # pylint: disable=broad-except
                errors.append(error)

        threads = [threading.Thread(target=work, args=(number,)) for number in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
        self.assertEqual(errors, [])
        self.assertTrue(eventually(lambda: [x.value for x in robot.tuples("work.*", PC)] == ["19"] * 8))

    def test_callbacks_in_poll(self):
        robot, got = self.peer("robot", callbacks="poll"), []
        robot.subscribe("k", lambda x: got.append((threading.current_thread(), x.value)))
        robot["k"] = "1"
        self.assertEqual(got, [])
        self.assertEqual(robot.poll(5), 1)
        self.assertEqual(got, [(threading.main_thread(), "1")])
        self.assertEqual(robot.poll(), 0)

    def test_errors(self):
        robot = self.peer("robot")
        self.assertRaises(RefusedError, robot.set, "kernel.name", "x", PC)
        self.assertRaises(RefusedError, robot.set, "kernel.name", "x")
        self.assertRaises(BadValueError, robot.set, "a.*", "x")
        self.assertRaises(BadValueError, robot.set, "a", None)
        self.assertRaises(BadValueError, robot.set, "a", "x", mimetype="")
        self.assertRaises(BadValueError, robot.get, "a", 0)
        self.assertRaises(NoSuchTupleError, robot.append, "nothing", "x")
        self.assertRaises(NoSuchTupleError, robot.get, "nothing", PC, timeout=0.3)
        self.assertEqual(robot.get("nothing", PC, timeout=0.1, default="?"), "?")
        self.assertRaises(NoSuchHostError, robot.get, "k", 31, timeout=0.3)
        self.assertRaises(NoSuchHostError, robot.set, "k", "v", "nobody", timeout=0.3)
        robot.close()
        robot.close()
        self.assertRaises(ClosedError, robot.get, "k", PC)
        self.assertRaises(ClosedError, robot.set, "k", "v")

    def test_an_id_that_is_in_use(self):
        self.peer("first", id=77)
        time.sleep(0.2)
        with self.assertRaises(NotConnectedError) as raised:
            Peer("second", self.binary.address, id=77, timeout=4)
        self.assertIn("its id is used by first@", str(raised.exception))

    def test_another_network(self):
        with self.assertRaises(NotConnectedError) as raised:
            Peer("robot", self.binary.address, network="other", timeout=1)
        self.assertIn("closed by the other end", str(raised.exception))


class RelayTest(WithBinary):
    def test_peers_reach_each_other_over_the_binary(self):
        a, b = self.peer("a"), self.peer("b")
        self.assertEqual(a.wait_for_host("b"), b.id)
        self.assertEqual([x.linked for x in a.hosts() if x.id == b.id], [False])
        got = []
        b.subscribe("position", got.append, owner="a")
        a["position"] = "2 3"
        self.assertTrue(eventually(lambda: [x.text for x in got] == ["2 3"]))
        b.set("command", "stop", owner="a")
        self.assertEqual(a["command"], "stop")
        a["map"] = bytes(1 << 20)
        self.assertEqual(len(b.get("map", "a", timeout=30)), 1 << 20)
        self.assertEqual(b.append("command", " now", owner="a"), None)
        self.assertTrue(eventually(lambda: a["command"] == "stop now"))
        start = time.monotonic()
        a.close()
        self.assertTrue(eventually(lambda: len(got) == 2, 3))
        self.assertLess(time.monotonic() - start, 2)
        self.assertTrue(got[1].deleted)
        self.assertRaises(PeerError, b.set, "command", "go", a.id, timeout=0.5)

    def test_peers_reach_each_other_directly(self):
        with Peer("hub", listen="tcp://127.0.0.1:0") as hub, Peer("spoke", f"tcp://127.0.0.1:{hub.port}") as spoke:
            hub["k"] = "v"
            self.assertEqual(spoke.get("k", "hub"), "v")
            spoke.set("k", "w", hub.id)
            self.assertEqual(hub["k"], "w")

    def test_a_binary_that_connects_to_a_peer(self):
        with Peer("hub", listen="tcp://127.0.0.1:0") as hub:
            binary = Binary(RUBICON, more=f'connect = ["tcp://127.0.0.1:{hub.port}"]')
            self.addCleanup(binary.end)
            self.assertEqual(hub.wait_for_host("pc", timeout=10), PC)
            hub.set("k", "v", "pc")
            hub["own"] = "w"
            with Peer("other", binary.address) as other:
                self.assertEqual((other.get("k", "pc"), other.get("own", "hub")), ("v", "w"))

    def test_hostile_octets_close_their_link_alone(self):
        with Peer("hub", listen="tcp://127.0.0.1:0") as hub, Peer("spoke", f"tcp://127.0.0.1:{hub.port}") as spoke:
            for octets in (b"GET / HTTP/1.1\r\n\r\n" * 9, encode_connect(9, "rubicon") + b"\xff" * 40,
                           encode_connect(9, "rubicon")[:40]):
                with socket.create_connection(("127.0.0.1", hub.port)) as hostile:
                    hostile.settimeout(10)
                    hostile.sendall(octets)
                    if len(octets) > 76:
                        while hostile.recv(4096):
                            pass
            self.assertTrue(eventually(lambda: len(hub.closed_links()) == 3))
            self.assertIn("protocol version", hub.closed_links()[0])
            self.assertIn("wrong sync word", hub.closed_links()[1])
            hub["k"] = "v"
            self.assertEqual(spoke.get("k", "hub"), "v")


class OtherKernelTest(unittest.TestCase):
    """A stand-in for a G6 kernel, which reads a package only when all of it is there."""

    def test_long_values_reach_small_receive_buffers(self):
        with Peer("robot", listen="tcp://127.0.0.1:0", id=40) as robot:
            readers = [subprocess.Popen(
                [sys.executable, str(ROOT / "tests/interop/original.py"), "--connect", str(robot.port), "--owner", "40",
                 "--key", "big", "--network", "rubicon", "--id", str(50 + i), "--receive-buffer", str(buffer),
                 "--seconds", "60"], stdout=subprocess.PIPE, text=True) for i, buffer in enumerate((16384, 131072))]
            for reader in readers:
                self.addCleanup(reader.stdout.close)
                self.addCleanup(reader.kill)
                self.assertIn("subscribed", reader.stdout.readline())
            head = f"1 {time.monotonic()} "
            robot["big"] = head + "x" * (900_000 - len(head))
            for reader in readers:
                self.assertIn("900001", reader.stdout.readline())
                self.assertEqual(reader.wait(70), 0)


class EndingTest(unittest.TestCase):
    def setUp(self):
        self.binary = Binary(RUBICON)
        self.addCleanup(self.binary.end)

    def test_a_binary_that_is_killed_and_comes_back(self):
        got = []
        with Peer("robot", self.binary.address) as robot:
            robot.subscribe("k", got.append, PC)
            robot.set("k", "1", PC)
            self.assertTrue(eventually(lambda: len(got) == 1))
            self.binary.kill()
            start = time.monotonic()
            self.assertRaises(PeerError, robot.set, "k", "2", PC)
            self.assertLess(time.monotonic() - start, 5)
            start = time.monotonic()
            with self.assertRaises(NotConnectedError) as raised:
                robot.get("other", PC)
            self.assertIn("not connected: 127.0.0.1:", str(raised.exception))
            self.assertLess(time.monotonic() - start, 5)
            self.assertFalse(robot.connected)
            again = Binary(RUBICON, self.binary.port)
            self.addCleanup(again.end)
            robot.set("k", "3", PC, timeout=20)
            self.assertTrue(eventually(lambda: not got[-1].deleted and got[-1].text == "3"))

    def test_a_binary_that_is_killed_during_a_request(self):
        with Peer("robot", self.binary.address) as robot:
            robot.wait_for_host(PC)
            self.binary.process.send_signal(signal.SIGSTOP)
            threading.Timer(0.5, self.binary.process.kill).start()
            start = time.monotonic()
            self.assertRaises(PeerError, robot.set, "k", "v", PC)
            self.assertLess(time.monotonic() - start, 5)
            start = time.monotonic()
        self.assertLess(time.monotonic() - start, 4)

    def program(self):
        """Another process with the peer 88, until something is written to it."""
        text = textwrap.dedent(f"""
            import sys
            sys.path.insert(0, {str(ROOT / 'python')!r})
            from rubicon import Peer
            peer = Peer("victim", {self.binary.address!r}, id=88)
            peer["k"] = "v"
            print("up", flush=True)
            sys.stdin.readline()""")
        process = subprocess.Popen([sys.executable, "-B", "-c", text], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                   text=True)
        for each in (process.stdin.close, process.stdout.close, process.wait, process.kill):
            self.addCleanup(each)
        self.assertEqual(process.stdout.readline().strip(), "up")
        return process

    def test_a_program_that_ends(self):
        program, got = self.program(), []
        with Peer("robot", self.binary.address) as robot:
            robot.subscribe("k", lambda x: got.append((time.monotonic(), x.deleted)), 88)
            self.assertTrue(eventually(lambda: len(got) == 1))
            program.stdin.write("\n")
            program.stdin.flush()
            self.assertEqual(program.wait(10), 0)
            ended = time.monotonic()
            self.assertTrue(eventually(lambda: len(got) == 2))
            self.assertLess(got[1][0] - ended, 2)
            self.assertTrue(got[1][1])

    def test_a_peer_that_is_killed(self):
        victim = self.program()
        with Peer("robot", self.binary.address) as robot:
            self.assertEqual(robot.get("k", 88), "v")
            victim.kill()
            victim.wait()
            self.assertTrue(eventually(lambda: all(x.id != 88 for x in robot.hosts()), 15))
            robot.set("k", "still here", PC)
            self.assertIn("still here", self.binary.tuples("get", "k", "--owner", "pc"))

    def test_nobody_listens(self):
        start = time.monotonic()
        with self.assertRaises(NotConnectedError) as raised:
            Peer("robot", f"tcp://127.0.0.1:{free_port()}", timeout=1)
        self.assertIn("Connection refused", str(raised.exception))
        self.assertLess(time.monotonic() - start, 4)


if __name__ == "__main__":
    unittest.main(verbosity=2)
