#!/usr/bin/env python3
"""Kernels of the Python peer in one process and virtual time: without sockets, threads and clocks.
usage: core_test"""
import random
import unittest

from support import VirtualNetwork

from rubicon import records, wire
from rubicon.delivery import ATTEMPTS_MAX, PARTIAL_MAX, WINDOW, Delivery, IdSource, Reassembly, SeenIds
from rubicon.feed import SUBSCRIBERS_OF_HOST_MAX
from rubicon.records import Prototype
from rubicon.wire import Header, Port


def set_own(network, id, key, octets=b"1\0", expires=None):
    space = network.kernels[id].space
    space.set_own(space.draft(id, key, (octets, "text/plain", 0), expires, 0.0, network.now), network.now)


class DeliveryTest(unittest.TestCase):
    def setUp(self):
        self.ids = IdSource(random.Random(1))
        self.delivery = Delivery(1, self.ids)

    def test_repeats_with_growing_waits(self):
        self.delivery.add(5, 2, 10, b"x")
        first, _ = self.delivery.next(2, 0.0)
        sent, failed, now = [0.0], [], 0.0
        while not failed:
            now = self.delivery.deadline()
            again, failed = self.delivery.due(now)
            sent += [now] * len(again)
            for header, _ in again:
                self.assertEqual(header.ack_id, first.ack_id)
                self.assertNotEqual(header.id, first.id)
        self.assertEqual([round(x / 0.4) for x in sent], [0, 1, 3, 6, 10, 15, 21])
        self.assertEqual(len(sent), ATTEMPTS_MAX)
        self.assertAlmostEqual(now, 11.2)
        self.assertEqual(failed[0].token, 5)
        self.assertTrue(self.delivery.is_idle())

    def test_a_window_of_packages_is_in_flight(self):
        self.delivery.add(1, 2, 10, bytes(1024 * (WINDOW + 5)))
        sent = []
        while (package := self.delivery.next(2, 0.0)) is not None:
            sent.append(package[0])
        self.assertEqual(len(sent), WINDOW)
        self.assertIsNone(self.delivery.acknowledge(3, sent[0].ack_id))  # it was sent to another peer
        self.assertIsNone(self.delivery.acknowledge(2, sent[0].ack_id))
        self.assertIsNotNone(self.delivery.next(2, 0.0))

    def test_too_long_a_message_is_refused(self):
        self.assertTrue(self.delivery.add(1, 2, 10, bytes(16384 * 1024 + 1)))

    def test_fragments_in_any_order(self):
        parts, assembly = [], Reassembly()
        self.delivery.add(1, 2, 10, bytes(range(256)) * 20)
        while (package := self.delivery.next(2, 0.0)) is not None:
            parts.append(package)
        random.Random(1).shuffle(parts)
        whole = [assembly.add(*part, 0.0) for part in parts]
        self.assertEqual(whole[-1], bytes(range(256)) * 20)
        self.assertEqual(whole[:-1], [None] * (len(parts) - 1))

    def test_partial_messages_are_bounded_and_dropped_late(self):
        assembly = Reassembly()

        def header(group):
            return Header(1, 1, wire.DIRECT, 9, 1, 10, 1024, fragments=2, group=group)

        for group in range(PARTIAL_MAX):
            self.assertTrue(assembly.accepts(header(group)))
            assembly.add(header(group), bytes(1024), 0.0)
        self.assertFalse(assembly.accepts(header(PARTIAL_MAX)))
        self.assertEqual(assembly.on_time(9.9), 0)
        self.assertEqual(assembly.on_time(10.0), PARTIAL_MAX)
        self.assertTrue(assembly.accepts(header(PARTIAL_MAX)))

    def test_seen_numbers_are_bounded(self):
        seen = SeenIds(2)
        self.assertEqual([seen.insert(1, x) for x in (1, 2, 1, 3, 1)], [True, True, False, True, True])


class NetworkTest(unittest.TestCase):
    def pair(self, **how):
        network = VirtualNetwork(1, 2, **how)
        self.link = network.connect(1, 2)
        network.run(0.5)
        return network

    def watch(self, network, id, wanted):
        got = []
        network.kernels[id].space.subscribe(wanted, got.append, network.now)
        return got

    def test_neighbours_know_each_other(self):
        network = self.pair()
        for a, b in ((1, 2), (2, 1)):
            self.assertTrue(network.kernels[a].overlay.hosts[b].announced)
            self.assertEqual(network.kernels[a].overlay.routes[b].hops, 1)

    def test_values_reach_subscribers_first_and_later(self):
        network = self.pair()
        set_own(network, 1, "a.b", b"1\0")
        got = self.watch(network, 2, Prototype(-1, "a.*"))
        network.run(0.2)
        set_own(network, 1, "a.b", b"2\0")
        set_own(network, 1, "a.c.d", b"3\0")
        network.run(0.2)
        network.kernels[1].space.delete_own("a.b", network.now)
        network.run(0.2)
        self.assertEqual([(x.text, x.deleted) for x in got], [("1", False), ("2", False), ("2", True)])
        self.assertEqual(list(network.kernels[2].space.held), [])

    def test_late_peers_are_asked_too(self):
        network = VirtualNetwork(1, 2)
        got = self.watch(network, 2, Prototype(1, "k"))
        set_own(network, 1, "k")
        network.connect(2, 1)
        network.run(0.5)
        self.assertEqual(len(got), 1)

    def test_a_megabyte_arrives_though_packages_are_lost(self):
        network = self.pair(loss=0.1)
        network.run(2)
        octets = random.Random(4).randbytes(1 << 20)
        got = self.watch(network, 2, Prototype(1, "big"))
        set_own(network, 1, "big", octets)
        network.run(30)
        self.assertEqual([x.octets == octets for x in got], [True])

    def test_others_write_append_and_delete(self):
        network = self.pair()
        space, outcome = network.kernels[1].space, []
        x = space.draft(2, "k", (b"one\0", "text/plain", 0), None, 0.0, network.now)
        network.kernels[1].send(2, Port.SET, records.encode_tuple(x, False), outcome.append)
        network.run(0.2)
        own = network.kernels[2].space.own["k"]
        self.assertEqual((own.text, own.creator, own.owner), ("one", 1, 2))
        network.kernels[1].send(2, Port.APPEND, records.encode_append(Prototype(2, "k"), b" two\0"), outcome.append)
        network.run(0.2)
        self.assertEqual(network.kernels[2].space.own["k"].text, "one two")
        network.kernels[1].send(2, Port.SET, records.encode_tuple(records.deletion_of(x), False), outcome.append)
        network.run(0.2)
        self.assertNotIn("k", network.kernels[2].space.own)
        self.assertEqual(outcome, ["", "", ""])

    def test_kernel_tuples_are_not_written_by_others(self):
        network = self.pair()
        x = network.kernels[1].space.draft(2, "Kernel.id", (b"9\0", "text/plain", 0), None, 0.0, network.now)
        network.kernels[1].send(2, Port.SET, records.encode_tuple(x, False), lambda _: None)
        network.run(0.2)
        self.assertEqual(network.kernels[2].space.own["kernel.id"].text, "2")

    def test_notices_of_appends_extend_what_is_held(self):
        network = self.pair()
        set_own(network, 1, "k", b"one\0")
        got = self.watch(network, 2, Prototype(1, "k"))
        network.run(0.2)
        before = network.kernels[1].space.own["k"]
        after = records.Tuple(**{**before.__dict__, "octets": b"one two\0", "appends": 1})
        network.kernels[1].space.own["k"] = after  # as an owner that sends notices
        network.kernels[1].send(2, Port.APPENDED, records.encode_appended(before, b" two\0"), lambda _: None)
        network.run(0.2)
        self.assertEqual([x.text for x in got], ["one", "one two"])
        missed = records.Tuple(**{**after.__dict__, "octets": b"one two three\0"})
        network.kernels[1].space.own["k"] = records.Tuple(**{**after.__dict__, "octets": b"one two three four\0"})
        network.kernels[1].send(2, Port.APPENDED, records.encode_appended(missed, b" four\0"), lambda _: None)
        network.run(0.2)
        self.assertEqual(got[-1].text, "one two three four")

    def test_tuples_expire_everywhere(self):
        network = self.pair()
        got = self.watch(network, 2, Prototype(1, "k"))
        set_own(network, 1, "k", expires=3.0)
        network.run(2.5)
        self.assertEqual([x.deleted for x in got], [False])
        network.run(1)
        self.assertEqual([x.deleted for x in got], [False, True])
        self.assertNotIn("k", network.kernels[1].space.own)

    def test_subscriptions_are_refreshed_and_end_with_their_lifetime(self):
        network = self.pair()
        self.watch(network, 2, Prototype(1, "k"))
        network.run(150)
        self.assertEqual(list(network.kernels[1].space.feed.subscribers()), [2])
        number = next(iter(network.kernels[2].space._subscriptions))
        network.kernels[2].space.unsubscribe(number)
        network.run(1)
        self.assertEqual(list(network.kernels[1].space.feed.subscribers()), [])

    def test_idle_links_last(self):
        network = self.pair()
        network.run(60)
        self.assertIn(self.link, network.kernels[1].overlay.links)

    def test_a_silent_neighbour_is_given_up(self):
        network = self.pair()
        self.watch(network, 1, Prototype(2, "k"))
        set_own(network, 2, "k")
        network.run(2)  # heartbeats have begun
        self.assertTrue(network.kernels[1].space.held)
        del network.cables[2, self.link]  # nothing comes any more
        outcome = []
        network.kernels[1].send(2, Port.APPEND, b"x", outcome.append)
        network.run(4.5)
        self.assertEqual(network.kernels[1].overlay.links, {})
        network.run(3.5)
        self.assertEqual(network.kernels[1].space.held, {})
        self.assertEqual(outcome, ["peer 2 has gone"])

    def test_values_go_on_after_a_cut(self):
        network = self.pair()
        got = self.watch(network, 2, Prototype(1, "k"))
        set_own(network, 1, "k", b"1\0")
        network.run(0.3)
        network.cut(self.link)
        set_own(network, 1, "k", b"2\0")
        network.run(1)
        network.connect(2, 1)
        network.run(3)
        self.assertEqual([x.text for x in got], ["1", "2"])

    def test_who_leaves_is_gone_at_once(self):
        network = self.pair()
        network.kernels[1].overlay.leave()
        network.run(0.1)
        self.assertEqual(network.kernels[2].overlay.hosts, {})

    def test_a_restarted_peer_is_another_incarnation(self):
        network = self.pair()
        got = self.watch(network, 1, Prototype(2, "k"))
        set_own(network, 2, "k", b"old\0")
        network.run(0.3)
        network.cut(self.link)
        network.kernels[2] = network.kernel(2)
        set_own(network, 2, "k", b"new\0")
        network.connect(2, 1)
        network.run(1)
        self.assertEqual([(x.text, x.deleted) for x in got], [("old", False), ("old", True), ("new", False)])

    def test_clocks_agree(self):
        network = self.pair()
        network.kernels[2].overlay.clock._offset += 100
        network.run(5)
        times = [x.overlay.clock.at(network.now) for x in network.kernels.values()]
        self.assertAlmostEqual(times[0], times[1], delta=0.05)

    def test_subscriptions_of_others_are_bounded(self):
        network = self.pair()
        for i in range(SUBSCRIBERS_OF_HOST_MAX + 5):
            message = records.encode_subscribe(records.Subscribe(Prototype(1, f"k{i}"), 60))
            network.kernels[1].space.on_arrived(Port.SUBSCRIBE, 2, message, network.now)
        self.assertEqual(network.kernels[1].space.feed.refused, 5)


class HostileTest(unittest.TestCase):
    """Whatever arrives, a kernel does not raise, and closes broken links with a reason."""

    def setUp(self):
        self.network = VirtualNetwork(1)
        self.kernel = self.network.kernels[1]

    def octets(self, octets, accepted=True):
        self.kernel.overlay.link_opened(7, not accepted, "127.0.0.1:1", 100.0)
        self.kernel.link_octets(7, octets, 100.0)
        return [x.why for x in self.kernel.take_notices() if not x.up]

    def test_connect_requests(self):
        good = wire.encode_connect(2, "rubicon")
        for octets, why in ((good[:3] + b"\0" + good[4:], "version"), (wire.encode_connect(2, "other"), "network"),
                            (wire.encode_connect(1, "rubicon"), "id 1"), (wire.encode_connect(-1, "rubicon"), "id -1"),
                            (good[:12] + b"x" * 64, "NUL"), (b"GET / HTTP/1.1\r\n" * 5, "")):
            closed = self.octets(octets)
            self.assertEqual(len(closed), 1, octets)
            self.assertIn(why, closed[0])

    def test_garbage_after_the_request(self):
        closed = self.octets(wire.encode_connect(2, "rubicon") + b"\xff" * 100)
        self.assertIn("sync word", closed[0])

    def test_oversized_packages(self):
        package = bytearray(wire.encode_package(Header(1, 1, 0, 2, -1, 13), b""))
        package[30:32] = b"\x04\x01"
        self.assertIn("1025 octets", self.octets(bytes(package), accepted=False)[0])

    def test_a_request_that_does_not_come(self):
        self.assertEqual(self.octets(b"\0\0"), [])
        self.kernel.on_time(106.0)
        self.assertIn("silent", [x.why for x in self.kernel.take_notices()][0])

    def test_messages_at_random(self):
        rng = random.Random(5)
        self.kernel.overlay.link_opened(7, True, "127.0.0.1:1", 100.0)
        for i in range(20000):
            data = rng.randbytes(rng.choice((0, 4, 8, 12, 24, 224, 250, 552, 1024)))
            header = Header(i + 1, i + 1, rng.randrange(4), rng.choice((2, 3, 1)), rng.choice((-1, 1, 2)),
                            rng.randrange(60), len(data), rng.randrange(16), rng.randrange(16),
                            fragments=rng.choice((0, 0, 1, 3)), group=rng.randrange(3), fragment=rng.randrange(3))
            self.kernel.link_octets(7, wire.encode_package(header, data), 100.0 + i / 1000)
            if i % 100 == 0:
                self.kernel.on_time(100.0 + i / 1000)
        self.assertGreater(self.kernel.overlay.counters["malformed"], 100)
        self.assertGreater(self.kernel.overlay.counters["illegal"], 100)


if __name__ == "__main__":
    unittest.main(verbosity=2)
