// Somebody who has recorded, stolen or kept something, and speaks to peers in others' names.
#pragma once

#include <algorithm>

#include "core/codec.hpp"
#include "smepp/crypto/handshake.hpp"
#include "unit/smepp/world.hpp"

namespace rubicon::smepp::test {

inline group_description kitchen(duration period = 0s) {
  group_description x{.name = "kitchen", .master = key_of(9), .is_closed = true};
  if (period > 0s)
    x.management = {period, 100ms};
  return x;
}

inline group_id create(world& w, std::size_t i, const group_description& x) {
  return std::get<group_id>(w.with(
      i, [&](peer& each, instant t, outputs& out) { return each.smepp_createGroup(x, t, out); }));
}

inline const group& group_of(world& w, std::size_t i, group_id id) {
  return *w.at(i).groups().find(id);
}

inline bool is_in(world& w, std::size_t i, group_id id) {
  return w.at(i).groups().find(id) != nullptr;
}

inline std::uint64_t sent(world& w, std::size_t i, const std::string& what) {
  const auto& all = w.at(i).counters().sent;
  return all.contains(what) ? all.at(what) : 0;
}

/// Somebody within reach of all, under any name.
class intruder {
public:
  /// Has the network's keys. @param counter above those that its names have used
  explicit intruder(world& w, std::uint64_t counter = 20'000) : w_(w), counter_(counter) {}

  void say(std::size_t to, mote_id name, mote_id receiver, const message& x,
           group_id group = network_level, session_id session = {},
           const std::vector<session_keys>& keys = {}) {
    auto own = sealer(name, group, keys);
    w_.inject(to, name, receiver, *own.seal(receiver, group, session, encode(x)));
  }

  /// The messages that somebody has sent to a name, at network level.
  template <class Message>
  std::vector<Message> overheard(mote_id from, mote_id to) {
    std::vector<Message> all;
    security own({.self = mote_id{200}}, 0);
    own.set_network_keys(w_.network, w_.now());
    for (const auto& x : w_.air()) {
      if (x.from != from || x.to != to)
        continue;
      const auto opened = own.open(x.from, x.to, x.octets, w_.now());
      if (const auto* const frame = std::get_if<opened_frame>(&opened))
        if (const auto said = decode(frame->content))
          if (const auto* const found = std::get_if<Message>(&*said))
            all.push_back(*found);
    }
    return all;
  }

private:
  security sealer(mote_id name, group_id group, const std::vector<session_keys>& keys) {
    security own({.self = name}, counter_ += 3);
    own.set_network_keys(w_.network, w_.now());
    if (group != network_level)
      own.set_group(group, keys);
    return own;
  }

  world& w_;
  std::uint64_t counter_;
};

/// What an intruder gets who joins, or catches up, in another's name.
struct break_in {
  bool was_asked = false;
  bool was_admitted = false;
  bool has_keys = false; ///< and could open them
};

inline break_in enter_as(world& w, std::size_t at, mote_id name, const group_description& x,
                         group_id group, bool as_member, const agreement& identity,
                         const key_share& shown) {
  const mote_id member{static_cast<std::uint16_t>(at)};
  intruder who(w);
  randomness secrets{random_stream(55)};
  const auto own = agreement::make(secrets);
  w.record_air(true);
  w.forget_air();
  break_in result;
  who.say(at, name, member, join{group, 77});
  w.run_for(1s);
  const auto asked = who.overheard<join_challenge>(member, name);
  if (asked.empty())
    return result;
  result.was_asked = true;
  join_proof proof{group, 77, asked.back().cookie, 1, as_member, own.share(), shown, {}};
  handshake with{name, member, proof, {}, terms_of(x)};
  const auto credential = credential_of(x, w.network);
  proof.proof = join_tag(credential, with);
  who.say(at, name, member, proof);
  w.run_for(1s);
  const auto accepted = who.overheard<join_accept>(member, name);
  if (accepted.empty())
    return result;
  result.was_admitted = true;
  with.share = accepted.back().share;
  result.has_keys =
      unwrap(accept_key(credential, with, *own.agree(with.share), *identity.agree(with.share)),
             accepted.back().keys, carrier_of(accepted.back()))
          .has_value();
  return result;
}

inline std::vector<std::size_t> all_of(const world& w) {
  std::vector<std::size_t> all;
  for (std::size_t i = 1; i <= w.size(); ++i)
    all.push_back(i);
  return all;
}

} // namespace rubicon::smepp::test
