#!/usr/bin/env python3
"""Codecs of the Python peer: captures of real kernels, round trips, octets at random.
usage: codec_test"""
import random
import unittest

from support import golden

from rubicon import keys, meta, records, wire
from rubicon.errors import BadValueError, PeerError
from rubicon.link import Stream
from rubicon.records import Prototype, Subscribe, Tuple

KNOWN = 1795231488.0  # seconds since 1970, when the captures were made


def packages(name):
    stream = Stream(expects_request=False)
    stream.feed(golden(name))
    return list(stream.packages())


def only(name):
    found = packages(name)
    assert len(found) == 1, name
    return found[0]


class GoldenTest(unittest.TestCase):
    def test_a_connect_request(self):
        octets = golden("connect-from-real.hex")
        x = wire.decode_connect(octets)
        self.assertEqual(x, (500, 20, 4, "default"))
        self.assertEqual(wire.encode_connect(20, "default", 4), octets)

    def test_a_package_header(self):
        octets = golden("dead-host-exit.hex")
        header, data = only("dead-host-exit.hex")
        self.assertEqual((header.id, header.type, header.source, header.destination, header.port, header.counter),
                         (0x3a192b2c, wire.BROADCAST, 20, -1, wire.Port.DEAD_HOST, 0x87))
        self.assertEqual(wire.encode_package(header, data), octets)
        self.assertEqual(wire.DEAD.unpack(data), {"id": 20, "reason": 1})

    def test_a_host_record(self):
        header, data = only("hostinfo-link.hex")
        record, cached = wire.decode_host(data)
        self.assertFalse(cached)
        self.assertEqual((record.id, record.host_name, record.marked), (header.source, "hostA", False))
        again, _ = wire.decode_host(wire.encode_host(record))
        self.assertEqual(again, record)
        self.assertTrue(wire.decode_host(only("hostinfo-reply-cached.hex")[1])[1])

    def test_routing_pages(self):
        pages = [wire.decode_page(data) for _, data in packages("routing-two-pages.hex")]
        self.assertEqual([x.page for x in pages], [0, 1])
        self.assertEqual(len(pages[0].entries), 70)
        for (_, data), page in zip(packages("routing-two-pages.hex"), pages):
            self.assertEqual(wire.decode_page(wire.encode_page(page)), page)
            self.assertEqual(len(wire.encode_page(page)), len(data))

    def test_acknowledgements(self):
        for name in ("acks-one.hex", "acks-many.hex"):
            data = only(name)[1]
            self.assertEqual(wire.encode_acks(wire.decode_acks(data)), data)

    def test_clocks(self):
        time, master, _ = wire.decode_clock(only("timesync-plain.hex")[1], KNOWN)
        self.assertAlmostEqual(time, 1795231488.266977, places=5)
        self.assertFalse(master)
        self.assertTrue(wire.decode_clock(only("timesync-master.hex")[1], KNOWN)[1])

    def test_a_push_in_fragments(self):
        found = packages("push-fragments.hex")
        self.assertEqual([x.fragment for x, _ in found], list(range(len(found))))
        x = records.decode_tuple(b"".join(data for _, data in found), KNOWN)
        self.assertEqual((x.key, x.mimetype, x.encoding, x.octets), ("blob", records.BINARY_MIMETYPE, 1, b"X" * 3000))

    def test_pushed_and_set_tuples_encode_back(self):
        for name, push in (("push-first-value.hex", True), ("push-update.hex", True), ("push-expiring.hex", True),
                           ("push-metatuple.hex", True), ("set-remote.hex", False), ("set-metatuple.hex", False)):
            data = only(name)[1]
            x = records.decode_tuple(data, KNOWN)
            again = records.encode_tuple(x, push)
            self.assertEqual(records.decode_tuple(again, KNOWN), x, name)
            self.assertEqual(again[40:48], data[40:48], name)  # has a value, and its length
            self.assertEqual(again[224:], data[224:], name)

    def test_a_deletion(self):
        x = records.decode_tuple(only("set-delete.hex")[1], KNOWN)
        self.assertEqual((x.expires, len(x.octets)), (records.DELETED, 1))

    def test_subscriptions(self):
        x = records.decode_subscribe(only("subscribe-exact.hex")[1], KNOWN)
        self.assertIsNone(x.lifetime)
        self.assertFalse(keys.is_pattern(x.wanted.key))
        self.assertEqual(records.decode_subscribe(only("subscribe-any-owner.hex")[1], KNOWN).wanted.owner, -1)
        x = records.decode_subscribe(only("subscribe-mime-data.hex")[1], KNOWN)
        self.assertEqual(records.decode_subscribe(records.encode_subscribe(x), KNOWN), x)
        self.assertIsNotNone(x.wanted.mimetype)
        self.assertIsNotNone(x.wanted.octets)
        self.assertEqual(records.decode_unsubscribe(only("unsubscribe-any-owner.hex")[1])[0], -1)

    def test_appends(self):
        wanted, added = records.decode_append(only("append-request.hex")[1], KNOWN)
        self.assertEqual(records.decode_append(records.encode_append(wanted, added), KNOWN), (wanted, added))
        found = packages("push-appended.hex")
        notices = [records.decode_appended(data) for header, data in found if header.port == wire.Port.APPENDED]
        for x in notices:
            self.assertTrue(x.added)
            self.assertGreater(x.length, 0)
        self.assertTrue(notices)

    def test_a_reference(self):
        x = records.decode_tuple(only("push-metatuple.hex")[1], KNOWN)
        reference = meta.read_reference(x)
        self.assertEqual(meta.parse_reference(meta.format_reference(reference)), reference)


class RoundTripTest(unittest.TestCase):
    def test_tuples(self):
        for x in (Tuple(1, "a.b", b"2 3\0", creator=65535, written=(KNOWN // 1, 7), expires=(1795239999, 5), seqno=9),
                  Tuple(7, "x", b"", "x-rubicon/empty", 1, 7), Tuple(7, "K" * 127, bytes(1000), "m" * 254, 1, 7)):
            x = Tuple(**{**x.__dict__, "written": (int(x.written[0]), x.written[1])})
            self.assertEqual(records.decode_tuple(records.encode_tuple(x, True), KNOWN), x)

    def test_subscriptions_with_a_lifetime(self):
        x = Subscribe(Prototype(-1, "a.*", "text/plain", b"v\0"), 60, True)
        self.assertEqual(records.decode_subscribe(records.encode_subscribe(x), KNOWN), x)

    def test_notices_of_appends(self):
        before = Tuple(3, "a", b"12\0", seqno=4, appends=5, creator=3)
        self.assertEqual(records.decode_appended(records.encode_appended(before, b"3\0")), (3, "a", 4, 5, 3, b"3\0"))

    def test_times_beyond_32_bits(self):
        self.assertEqual(wire.unwrap(5, float((1 << 32) + 3)), (1 << 32) + 5)
        self.assertEqual(wire.unwrap(0xFFFFFFFF, float(1 << 32)), (1 << 32) - 1)

    def test_keys(self):
        self.assertTrue(keys.matches("a.*", "A.b"))
        self.assertFalse(keys.matches("a.*", "a.b.c"))
        self.assertTrue(keys.matches("", "a.b"))
        self.assertEqual(keys.from_wire("1.2.3.4.5.6.7.8"), "1.2.3.4.5.6.7")
        for bad in ("", "a.*", "x*", "a" * 128, "1.2.3.4.5.6.7.8", "a\0b", "\ud800"):
            self.assertRaises(BadValueError, keys.check, bad)

    def test_references(self):
        self.assertIsNone(meta.parse_reference("(META -1 NULL)"))
        self.assertEqual(meta.parse_reference(" ( META 11 a.b "), (11, "a.b"))
        for bad in ("", "META 1 a", "(META x a)", "(META 0 a)", "(META 70000 a)", "(META 1 a.*)", "(META 1)"):
            self.assertRaises(PeerError, meta.parse_reference, bad)


class GarbageTest(unittest.TestCase):
    """Decoders raise WireError and nothing else, whatever they are given."""

    DECODERS = [wire.decode_connect, wire.decode_header, wire.decode_host, wire.decode_page, wire.decode_acks,
                wire.decode_trace, lambda x: wire.decode_clock(x, KNOWN), wire.decode_heartbeat,
                lambda x: records.decode_tuple(x, KNOWN), lambda x: records.decode_subscribe(x, KNOWN),
                records.decode_unsubscribe, lambda x: records.decode_append(x, KNOWN), records.decode_appended]
    ENCODERS = {8: lambda x: records.encode_tuple(x, True), 9: records.encode_subscribe}

    def tried(self, octets):
        for i, decode in enumerate(self.DECODERS):
            try:
                x = decode(octets)
            except wire.WireError:
                continue
            if i in self.ENCODERS:
                self.ENCODERS[i](x)  # what was accepted can be sent on

    def test_octets_at_random(self):
        rng = random.Random(1)
        for _ in range(3000):
            self.tried(rng.randbytes(rng.choice((0, 3, 12, 40, 64, 76, 224, 228, 300, 552, 1024))))

    def test_captures_with_octets_changed_and_cut(self):
        rng = random.Random(2)
        names = ("push-update.hex", "set-remote.hex", "subscribe-mime-data.hex", "append-request.hex",
                 "push-appended.hex", "hostinfo-link.hex", "routing-one-page.hex", "acks-many.hex",
                 "timesync-plain.hex")
        for name in names:
            data = packages(name)[-1][1]
            for _ in range(500):
                octets = bytearray(data[:rng.choice((len(data), rng.randrange(len(data) + 1)))])
                for _ in range(rng.randrange(4)):
                    if octets:
                        octets[rng.randrange(len(octets))] = rng.randrange(256)
                self.tried(bytes(octets))

    def test_streams_in_any_pieces(self):
        octets = golden("connect-from-real.hex") + golden("push-fragments.hex")
        rng = random.Random(3)
        stream, found, at = Stream(expects_request=True), [], 0
        while at < len(octets):
            step = rng.randrange(1, 200)
            stream.feed(octets[at:at + step])
            at += step
            stream.request()
            found += stream.packages()
        self.assertEqual(len(found), len(packages("push-fragments.hex")))

    def test_broken_streams(self):
        whole = golden("dead-host-exit.hex")
        for at, octet in ((0, 0), (4, 0x80), (12, 0x80), (30, 0x04)):
            stream = Stream(expects_request=False)
            octets = bytearray(whole)
            octets[at] = octet
            octets[31] = 1 if at == 30 else octets[31]
            stream.feed(bytes(octets))
            self.assertRaises(wire.WireError, list, stream.packages())


if __name__ == "__main__":
    unittest.main(verbosity=2)
