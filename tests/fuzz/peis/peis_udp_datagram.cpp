// A UDP port under any datagrams: from strangers, and from the other end of a session. What decodes
// encodes back; what is kept is bounded; who has not proved its address gets no more than it sent.
#include <algorithm>
#include <cstdint>

#include "fuzz/require.hpp"
#include "peis/udp/udp_port.hpp"

using namespace rubicon;
using namespace rubicon::peis;

namespace {

constexpr udp_address other{{10, 0, 0, 2}, 2};
constexpr udp_address stranger{{10, 0, 0, 3}, 3};

void check_round_trip(byte_view octets) {
  const auto decoded = decode_udp_datagram(octets);
  if (!decoded)
    return;
  bytes again;
  if (const auto* segment = std::get_if<udp_segment>(&*decoded))
    encode(*segment, again);
  else
    again = encode(std::get<udp_handshake>(*decoded));
  require(again.size() == octets.size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    const bool is_zero = i == 5 || (again.size() >= udp_segment_header && (i == 46 || i == 47));
    require(is_zero || again[i] == octets[i]);
  }
}

/// A session that the other end has asked for.
void open(udp_port& port, udp_token token) {
  port.on_datagram(other, encode(udp_handshake{udp_handshake::step::hello, 0, token, 0}),
                   instant{});
  auto out = port.flush(instant{});
  require(out.size() == 1);
  const auto cookie = std::get<udp_handshake>(*decode_udp_datagram(out[0].octets)).cookie;
  port.on_datagram(other, encode(udp_handshake{udp_handshake::step::open, 9, token, cookie}),
                   instant{});
  require(port.sessions() == 1);
}

/// As the session's other end would write it.
bytes made_fitting(byte_view octets, udp_token token) {
  auto x = to_bytes(octets);
  x.resize(std::max(x.size(), udp_segment_header + 1));
  bytes head;
  udp_segment segment;
  segment.token = token;
  encode(segment, head);
  std::copy_n(head.begin(), 6, x.begin());
  std::copy_n(head.begin() + 8, 8, x.begin() + 8);
  return x;
}

std::size_t size_of(const std::vector<udp_batch>& all) {
  std::size_t sum = 0;
  for (const auto& each : all)
    sum += each.octets.size();
  return sum;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  byte_view rest(data, size);
  constexpr udp_token token{0x1122334455667788};
  udp_port port({}, {1, 2});
  open(port, token);
  static_cast<void>(port.flush(instant{}));
  port.send(token, bytes(5000, 'x'));
  port.connect(attempt_id{1}, {{10, 0, 0, 4}, 4}, 5s, instant{});
  instant now{1s};
  while (!rest.empty()) {
    const auto how = rest[0];
    const auto piece = rest.subspan(1).first(std::min<std::size_t>(rest.size() - 1, how / 4 * 8U));
    rest = rest.subspan(1 + piece.size());
    check_round_trip(piece);
    now += how % 2 == 0 ? 1ms : 50ms;
    port.on_time(now);
    static_cast<void>(port.flush(now));
    if (how % 4 < 2) {
      port.on_datagram(stranger, piece, now);
      require(size_of(port.flush(now)) <= piece.size());
    } else {
      port.on_datagram(other, made_fitting(piece, token), now);
    }
    static_cast<void>(port.take_events());
    if (const auto* session = port.find(token))
      require(session->held() <= 2 * udp_session_config{}.parts_max);
    require(port.sessions() <= 1);
  }
  for (int i = 0; i < 100 && port.deadline(); ++i) {
    now = std::max(now, *port.deadline());
    port.on_time(now);
    static_cast<void>(port.take_events());
    static_cast<void>(port.flush(now));
  }
  require(port.unacknowledged() == 0 || port.deadline().has_value());
  return 0;
}
