#!/usr/bin/env python3
"""Kernels of the Python peer in one process and virtual time: without sockets, threads and clocks.
usage: core_test"""
import random
import unittest
from unittest import mock

from support import ROOT, VirtualNetwork, golden

from rubicon import records, tuples, wire
from rubicon.delivery import ATTEMPTS_MAX, PARTIAL_MAX, WINDOW, Delivery, IdSource, Reassembly, SeenIds
from rubicon.errors import RefusedError
from rubicon.feed import IN_FLIGHT_MAX, STRANGERS_MAX, SUBSCRIBERS_OF_HOST_MAX, SubscriberFeed
from rubicon.hosts import HostTable
from rubicon.link import Link
from rubicon.records import Prototype, Subscribe, Tuple
from rubicon.routing import Route, RoutingTable
from rubicon.wire import Entry, Header, HostRecord, Page, Port, decode_page


def set_own(network, id, key, octets=b"1\0", expires=None):
    space = network.kernels[id].space
    space.set_own(space.draft(id, key, (octets, "text/plain", 0), expires, 0.0, network.now), network.now)


def decode(push):
    return records.decode_tuple(push, 1e9)


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


class RoutingTest(unittest.TestCase):
    def setUp(self):
        self.table = RoutingTable(1, 111)
        self.links = [Link(number, True, "127.0.0.1:1", 0.0) for number in (1, 2)]

    def receive(self, link, *entries):
        self.links[link - 1].table = {entry.id: entry for entry in entries}
        self.table.update(self.links, 0.0)
        return self.table.routes

    def test_the_best_route_is_taken_and_kept(self):
        self.assertEqual(self.receive(1, Entry(9, 10, 5, 2, 1))[9], (1, 10, 4, 5))
        self.assertEqual(self.receive(2, Entry(9, 10, 5, 1, 1))[9].link, 2)
        self.assertEqual(self.receive(1, Entry(9, 10, 5, 1, 1))[9].link, 2)  # no better
        self.assertEqual(self.receive(1, Entry(9, 11, 5, 1, 1))[9].link, 1)  # newer
        self.assertEqual(self.receive(1)[9].link, 2)
        self.assertEqual(self.receive(2, Entry(9, 11, 5, 250, 1)), {})  # lost

    def test_an_incarnation_that_has_left_is_ignored(self):
        self.table.bury(9, 5, 0.0)
        self.assertEqual(self.receive(1, Entry(9, 99, 5, 1, 1)), {})
        self.assertIn(9, self.receive(1, Entry(9, 1, 6, 1, 1)))
        self.receive(1, Entry(9, 99, 5, 1, 1))
        self.table.update(self.links, 31.0)
        self.assertIn(9, self.table.routes)

    def test_an_earlier_incarnation_of_ours_is_overtaken(self):
        for magic, seqno, overtaken in ((111, 500, False), (112, 500, True), (112, 3, False), (112, -1, False)):
            self.receive(1, Entry(1, seqno, magic, 2, 1))
            self.assertEqual(self.table.take_own(self.links[0]), overtaken)
            self.assertNotIn(1, self.links[0].table)
        self.assertEqual(decode_page(self.table.own_page(1)).entries, (Entry(1, 501, 111, 0, 1),))

    def test_a_table_counts_when_all_of_its_pages_are_there(self):
        link, entries = self.links[0], tuple(Entry(i + 1, 1, 1, 1, 1) for i in range(70))
        self.assertFalse(link.note_page(Page(0, 2, 7, entries)))
        self.assertFalse(link.note_page(Page(1, 2, 8, entries[:1])))  # of another sending
        self.assertFalse(link.note_page(Page(0, 2, 7, entries)))
        self.assertTrue(link.note_page(Page(1, 2, 7, (Entry(99, 1, 1, 1, 1),))))
        self.assertEqual(len(link.table), 71)


class HostTableTest(unittest.TestCase):
    def test_what_others_remember_counts_if_it_fits_the_route(self):
        table, route = HostTable(), Route(1, 1, 1, 5)
        old, new = HostRecord(9, 4, "h", "p@h!1"), HostRecord(9, 5, "h", "p@h!2")
        self.assertFalse(table.believes(old, True, route))
        self.assertTrue(table.believes(new, True, route))
        self.assertTrue(table.believes(old, False, route))
        table.store(new)
        self.assertFalse(table.believes(old, True, None))
        self.assertTrue(table.is_restart(old))

    def test_queries_are_repeated_ever_more_rarely(self):
        table, now, sent = HostTable(), 0.0, []
        table.review(9, True, Route(1, 1, 1, 5), now)
        while len(sent) < 7:
            now = min(table.deadlines())
            sent += [now] * len(table.take_queries(now))
        self.assertEqual(sent, [0, 1, 3, 7, 15, 25, 35])
        table.store(HostRecord(9, 5, "h", "p@h!1"))
        self.assertEqual(table.review(9, True, Route(1, 1, 1, 5), now), (9, True, False))
        self.assertEqual(table.deadlines(), [])

    def test_marked_hosts_are_forgotten_sooner(self):
        for marked, patience in ((True, 3.0), (False, 30.0)):
            table = HostTable()
            table.store(HostRecord(9, 5, "h", "p@h!1", marked=marked))
            table.review(9, True, None, 0.0)
            table.review(9, False, None, 0.0)
            self.assertEqual(table.lost_by(patience - 0.1), [])
            self.assertEqual(table.lost_by(patience), [9])
            self.assertEqual(table.forget(9), (9,))


class FeedTest(unittest.TestCase):
    def setUp(self):
        self.sent = []  # key, sequence number and what is to be called
        self.feed = SubscriberFeed(lambda to, port, data, done: self.sent.append((decode(data), done)))

    def values(self, count, seqno=0):
        return {f"k{i}": Tuple(1, f"k{i}", b"v\0", creator=1, seqno=seqno) for i in range(count)}

    def test_the_newest_values_wait_for_a_slow_subscriber(self):
        own = self.values(IN_FLIGHT_MAX + 1)
        self.feed.subscribe(2, Subscribe(Prototype(1, ""), 60), True, own, 0.0)
        self.assertEqual(len(self.sent), IN_FLIGHT_MAX)
        last = f"k{IN_FLIGHT_MAX}"
        for seqno in (1, 2, 3):
            self.feed.publish(self.values(IN_FLIGHT_MAX + 1, seqno)[last], 0.0)
        self.sent[0][1]("")
        self.assertEqual([(x.key, x.seqno) for x, _ in self.sent[IN_FLIGHT_MAX:]], [(last, 3)])

    def test_a_push_that_has_failed_is_sent_again(self):
        self.feed.subscribe(2, Subscribe(Prototype(1, ""), 60), True, self.values(1), 0.0)
        self.sent.pop()[1]("lost")
        self.assertEqual(self.feed.deadline(), 1.0)
        self.feed.on_time(1.0)
        self.assertEqual(len(self.sent), 1)

    def test_a_host_that_is_gone_gets_nothing(self):
        self.feed.subscribe(2, Subscribe(Prototype(1, ""), 60), True, self.values(1), 0.0)
        self.feed.host_vanished(2)
        self.sent.pop()[1]("lost")
        self.feed.on_time(2.0)
        self.assertEqual(self.sent, [])

    def test_hosts_that_nobody_knows_are_bounded(self):
        for id in range(2, STRANGERS_MAX + 5):
            self.feed.subscribe(id, Subscribe(Prototype(1, "k")), False, {}, 0.0)
        self.assertEqual((len(self.feed.subscribers()), self.feed.refused), (STRANGERS_MAX, 3))
        self.feed.on_time(60.0)
        self.assertEqual(self.feed.subscribers(), {})


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

    def test_late_peers_get_subscriptions_too(self):
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

    def test_tuples_of_all_kinds_are_bounded(self):
        network = self.pair()
        self.watch(network, 2, Prototype(1, ""))
        network.run(0.2)
        with mock.patch.object(tuples, "HELD_MAX", 6):
            for i in range(8):
                set_own(network, 1, f"k{i}")
            network.run(0.2)
        self.assertEqual(len(network.kernels[2].space.held), 6)
        self.assertEqual(network.kernels[2].space.counters["no_room"], 7)
        with mock.patch.object(tuples, "OWN_OCTETS_MAX", 1000):
            self.assertRaises(RefusedError, set_own, network, 1, "big", bytes(1000))
        with mock.patch.object(tuples, "SUBSCRIPTIONS_MAX", 1):
            self.assertRaises(RefusedError, self.watch, network, 2, Prototype(1, "more"))

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

    def test_captures_with_octets_changed(self):
        rng = random.Random(6)
        captures = [golden(path.name) for path in sorted((ROOT / "tests/golden/peis").glob("*.hex"))
                    if path.name not in ("announce.hex", "connect-from-real.hex")]
        set_own(self.network, 1, "foo", b"1\0")
        self.kernel.space.subscribe(Prototype(-1, ""), lambda _: None, 100.0)
        links = 0
        for i in range(4000):
            now = 100.0 + i / 100
            octets = bytearray(rng.choice(captures))
            octets[24:28] = rng.choice((octets[24:28], b"\0\0\0\1"))  # the destination
            octets[4:8] = octets[12:16] = (i + 1).to_bytes(4, "big")
            for _ in range(rng.randrange(5)):
                octets[rng.randrange(len(octets))] = rng.randrange(256)
            if not self.kernel.overlay.links:
                links += 1
                self.kernel.overlay.link_opened(links, True, "127.0.0.1:1", now)
            self.kernel.link_octets(links, bytes(octets), now)
            self.kernel.on_time(now)
            for link in self.kernel.overlay.links.values():
                link.take_output(1 << 30)
        self.assertGreater(links, 100)

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
