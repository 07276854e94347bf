#include "radio/raw_frame.hpp"

#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::radio;

namespace {

constexpr std::uint16_t pan = 20;

bytes octets(std::initializer_list<int> x) {
  bytes out;
  for (const auto each : x)
    out.push_back(static_cast<std::uint8_t>(each));
  return out;
}

} // namespace

TEST_CASE("a raw frame of the layout of TinyOS is read as decoded", "[radio][NET-14]") {
  frame x;
  x.ack_request = true;
  x.dsn = 9;
  x.destination = mote_id{7};
  x.source = mote_id{5};
  const auto psdu = encode(x);
  const auto body = byte_view(psdu).first(psdu.size() - 2);
  const auto read = read_header(body, pan);
  CHECK(read.pan == pan);
  CHECK(read.dsn == 9);
  CHECK(read.destination == mote_id{7});
  CHECK(read.source == mote_id{5});
  CHECK(read.ack_request);
  CHECK(with_fcs(body) == psdu);
}

TEST_CASE("a long address stands for the mote in its low octets", "[radio]") {
  // FCF: data, ack request, one PAN, long addresses of 2006
  const auto x = read_header(octets({0x61, 0xdc, 3, 0xcd, 0xab, 2, 1, 0, 0,  0, 0, 0, 0, //
                                     9,    0,    0, 0,    0,    0, 0, 0, 'x'}),
                             pan);
  CHECK(x.dsn == 3);
  CHECK(x.destination == mote_id{0x102});
  CHECK(x.source == mote_id{9});
  CHECK(x.ack_request);
}

TEST_CASE("headers of 802.15.4-2015 may lack a number and PANs", "[radio]") {
  // no sequence number; long addresses, one PAN: no PAN at all
  const auto both = read_header(octets({0x61, 0xed, 7, 0, 0, 0, 0, 0, 0, 0, //
                                        8, 0, 0, 0, 0, 0, 0, 0}),
                                pan);
  CHECK(both.destination == mote_id{7});
  CHECK(both.source == mote_id{8});
  CHECK(both.dsn == 0);
  // short addresses, each with its PAN
  const auto two = read_header(octets({0x01, 0xa8, 4, 0xcd, 0xab, 7, 0, 0xce, 0xab, 8, 0}), pan);
  CHECK(two.dsn == 4);
  CHECK(two.destination == mote_id{7});
  CHECK(two.source == mote_id{8});
}

TEST_CASE("a raw frame to all, to nobody or cut short requests no acknowledgement", "[radio]") {
  for (const auto& each : {octets({0x61, 0x88, 1, 0x22, 0, 0xff, 0xff, 5, 0}), // to all
                           octets({0x21, 0x80, 1, 0x22, 0, 5, 0}), // without a destination
                           octets({0x61, 0x88, 1, 0x22, 0, 7}), octets({0x61, 0x88, 1})}) {
    const auto x = read_header(each, pan);
    CHECK(x.destination == broadcast_mote);
    CHECK(!x.ack_request);
  }
}
