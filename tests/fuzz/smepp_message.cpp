// What peers of SMEPP Light say to each other: a peer that receives anything, with good keys, stays
// sound.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <utility>

#include "core/bytes.hpp"
#include "smepp/smepp.hpp"

using namespace rubicon;
using namespace rubicon::smepp;

namespace {

key key_of(std::uint8_t x) {
  std::array<std::uint8_t, key::size> octets{};
  octets.fill(x);
  return key(octets);
}

/// A member of a group hears it from another one, twice.
void hear(byte_view octets) {
  const instant now{1h};
  peer x({.self = mote_id{1}}, random_stream(1), now);
  outputs out;
  x.smepp_newPeer(key_of(1), key_of(2), now, out);
  const auto group = std::get<group_id>(x.smepp_createGroup({.name = "meadow"}, now, out));
  const auto& ring = x.groups().find(group)->ring;
  security other({.self = mote_id{2}}, 0);
  other.set_network_keys({key_of(1), key_of(2)}, now);
  other.set_group(group, ring.accepted());
  const auto say = [&](group_id level, byte_view content, instant at) {
    const auto session = level == network_level ? session_id{} : ring.best().id;
    if (const auto frame = other.seal(mote_id{1}, level, session, content))
      x.on_frame(mote_id{2}, mote_id{1}, *frame, at, at, out);
  };
  // It asks whom it hears for the first time, and believes who answers.
  say(group, encode(unsubscribe{{mote_id{2}, 1}, {}}), now);
  for (const auto& each : outputs(out))
    if (const auto* const frame = std::get_if<send_frame>(&each)) {
      const auto received = other.open(mote_id{1}, mote_id{2}, frame->octets, now);
      const auto question = decode(std::get<opened_frame>(received).content);
      say(group, encode(proof{std::get<challenge>(*question).nonce}), now);
      x.on_sent(frame->id, true, now, now, out);
    }
  if (x.keys().counters().proofs != 1)
    std::abort();
  x.smepp_subscribe("light", group, 1h, 1, now, out);
  x.smepp_receive(group, "light", 0, now, out);
  for (int i = 1; i <= 2; ++i) {
    const auto at = now + std::chrono::seconds(i);
    say(group, octets, at);
    say(network_level, octets, at);
    x.on_frame(mote_id{2}, broadcast_mote, octets, at, at, out);
    x.on_sent(static_cast<std::uint64_t>(i) + 1, i == 1, at, at, out);
    x.on_time(at, out);
  }
  x.on_time(now + 1min, out);
}

/// Somebody who looks for a group, and wants in, hears it as an answer to each of its steps.
void hear_while_joining(byte_view octets) {
  const instant now{1h};
  peer x({.self = mote_id{1}}, random_stream(1), now);
  outputs out;
  x.smepp_newPeer(key_of(1), key_of(2), now, out);
  security other({.self = mote_id{2}}, 0);
  other.set_network_keys({key_of(1), key_of(2)}, now);
  const auto say = [&](byte_view content, instant at) {
    if (const auto frame = other.seal(mote_id{1}, network_level, {}, content))
      x.on_frame(mote_id{2}, mote_id{1}, *frame, at, at, out);
  };
  /// What it has sent last; all that it sends is acknowledged.
  const auto received = [&](instant at) {
    std::optional<message> last;
    for (const auto& each : std::exchange(out, {}))
      if (const auto* const frame = std::get_if<send_frame>(&each)) {
        const auto opened = other.open(mote_id{1}, frame->to, frame->octets, at);
        if (const auto* const found = std::get_if<opened_frame>(&opened))
          if (const auto said = decode(found->content))
            last = *said;
        x.on_sent(frame->id, true, at, at, out);
      }
    return last;
  };
  x.smepp_getGroups({.name = "meadow"}, now, out);
  const auto question = received(now);
  say(octets, now);
  say(encode(answer{std::get<discover>(*question).nonce,
                    group_id{7},
                    true,
                    false,
                    1,
                    0,
                    0,
                    {},
                    std::nullopt,
                    to_bytes(std::string_view("meadow"))}),
      now);
  x.on_time(now + 4s, out);
  static_cast<void>(received(now + 4s));
  x.smepp_joinGroup(group_id{7}, key_of(9), now + 5s, out);
  const auto asked = received(now + 5s);
  if (!asked || !std::holds_alternative<join>(*asked))
    std::abort();
  say(octets, now + 5s);
  say(encode(join_challenge{group_id{7}, std::get<join>(*asked).nonce, {}}), now + 5s);
  static_cast<void>(received(now + 5s));
  say(octets, now + 5s);
  auto mine = to_bytes(octets); // with the number that it asked with, where most answers have it
  if (mine.size() > 7) {
    const auto whole = encode(*asked);
    std::copy_n(whole.begin() + 1, 6, mine.begin() + 1);
    say(mine, now + 5s);
  }
  x.on_time(now + 1min, out);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const byte_view octets(data, size);
  if (size <= message_max)
    hear(octets);
  if (size <= message_max)
    hear_while_joining(octets);
  return 0;
}
