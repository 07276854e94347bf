// Packages: what nobody asked for, what never ends, what is not what it says.
#include <array>

#include "hostile/attack.hpp"
#include "peis/overlay/network_clock.hpp"
#include "peis/tuples/tuple_record.hpp"
#include "peis/wire/acknowledgement.hpp"
#include "peis/wire/announcement.hpp"
#include "peis/wire/dead_host.hpp"
#include "peis/wire/heartbeat.hpp"
#include "peis/wire/host_query.hpp"
#include "peis/wire/routing_page.hpp"
#include "peis/wire/trace.hpp"

namespace rubicon::hostile {

namespace {

using peis::package_type;

void say_false_acks(link& x) {
  std::array<std::int32_t, peis::acknowledgements_max> ids{};
  for (auto& id : ids)
    id = x.number();
  x.say({.port = peis::port::acknowledgements, .destination = x.whom().hub},
        peis::encode_acknowledgement(ids));
}

/// Wants everything, and never says that anything has come.
class never_acks : public attack {
public:
  using attack::attack;

  void say(link& x) override {
    const auto all = peis::prototype_of(any_peer, {});
    if (x.said_since_open < 5)
      return x.begin({.port = peis::port::subscribe,
                      .destination = x.rng().chance(0.7) ? whom().hub : whom().keeper,
                      .reliable = true},
                     encode(peis::subscribe_message{all, peis::lifetime_tag{}}));
    peis::tuple t;
    t.owner = whom().hub;
    t.creator = x.id;
    t.name = *peis::key::parse("heap.n" + std::to_string(x.rng().below(50)));
    t.value = payload(bytes(4000, 'x'));
    auto octets = encode_tuple_head(t, peis::tuple_message_kind::set);
    octets.insert(octets.end(), t.value.view().begin(), t.value.view().end());
    x.begin({.port = peis::port::set, .destination = t.owner, .reliable = true}, std::move(octets));
  }
  void hear(link&, const peis::received_package&) override {}
};

/// The same, and it does not even read.
class slow_reader : public never_acks {
public:
  using never_acks::never_acks;
  [[nodiscard]] bool reads(const link&) const override { return false; }
  [[nodiscard]] int receive_buffer() const override { return 4096; }
};

/// The same, and it reads a little now and then, as if it were about to go on.
class trickle_reader : public never_acks {
public:
  using never_acks::never_acks;
  [[nodiscard]] bool reads(const link& x) const override {
    return (x.counts().packages + x.counts().heard) % 64 == 0;
  }
  [[nodiscard]] int receive_buffer() const override { return 4096; }
};

/// One fragment of many messages each, never the last one, by whomever.
void say_fragment(link& x) {
  const bytes octets(peis::data_max, 'x');
  auto header = x.header_of({.port = static_cast<std::uint16_t>(5 + x.rng().below(40)),
                             .destination = x.whom().hub,
                             .reliable = x.rng().chance(0.5)},
                            octets.size());
  if (x.rng().chance(0.5))
    header.source = peer_id{static_cast<std::int32_t>(1 + x.rng().below(peer_id_max))};
  header.seqlen = static_cast<std::uint16_t>(2 + x.rng().below(peis::fragments_max - 1));
  header.seqid = static_cast<std::uint16_t>(1 + x.rng().below(32767));
  header.seqnum = static_cast<std::uint16_t>(x.rng().below(header.seqlen - 1U));
  x.say_as(header, octets);
}

/// Messages to ports that nobody listens to, by us or by nobody.
void say_message(link& x) {
  draft message{.port = static_cast<std::uint16_t>(peis::port::user_first + x.rng().below(30)),
                .destination = x.rng().chance(0.5) ? x.whom().hub : x.whom().keeper,
                .reliable = x.rng().chance(0.8)};
  if (x.rng().chance(0.3))
    message.source = peer_id{x.number()};
  x.begin(message, bytes(x.rng().below(3000), 'x'));
}

/// Packages that the hub is to pass on, to all that it has links to.
void say_for_others(link& x) {
  const std::array others{peer_id{1}, x.whom().keeper, x.whom().porch, x.whom().bystander};
  x.say({.port = static_cast<std::uint16_t>(peis::port::user_first + x.rng().below(30)),
         .destination = others.at(x.rng().below(others.size())),
         .reliable = x.rng().chance(0.5)},
        bytes(peis::data_max, 'x'));
}

void say_beat(link& x) {
  x.beat();
}

bytes good_message(link& x, std::uint16_t port) {
  namespace ports = peis::port;
  const auto wanted = peis::prototype_of(x.whom().hub, *peis::key::parse("heap.a"));
  peis::tuple t;
  t.owner = port == ports::set ? x.whom().hub : x.id;
  t.creator = x.id;
  t.name = wanted.name;
  switch (port) {
  case ports::routing:
    return encode(peis::routing_page{0, 1, x.next_seqno(), {{x.id, x.number(), x.magic, 0, 1}}});
  case ports::trace:
  case ports::trace_reply:
    return encode(peis::trace_message{{x.id}});
  case ports::subscribe:
    return encode(peis::subscribe_message{wanted, peis::lifetime_tag{}});
  case ports::unsubscribe:
    return peis::encode_unsubscribe(wanted);
  case ports::heartbeat:
    return encode(peis::heartbeat{instant{1s}, instant{}, 0s});
  case ports::dead_host:
    return encode(peis::dead_host_message{x.id, peis::dead_host_message::reason::reborn});
  case ports::clock:
    return encode(peis::clock_message{1'000'000'000s, false, 0s});
  case ports::host_query:
    return encode(peis::host_query{x.id, peis::any_magic});
  case ports::host_record:
    return encode(peis::host_record_message{x.record(), false});
  case ports::acknowledgements:
    return peis::encode_acknowledgement(std::array{x.number()});
  case ports::append_request:
    return peis::encode_append_request_head({wanted, payload()});
  case ports::append_notice:
    return encode_append_notice_head(t, 0);
  default:
    return encode_tuple_head(t, port == ports::set ? peis::tuple_message_kind::set
                                                   : peis::tuple_message_kind::push);
  }
}

/// Good messages of every service, then a few octets and the length are changed, then the header.
void say_mutated(link& x) {
  auto& rng = x.rng();
  const auto port = static_cast<std::uint16_t>(rng.below(17));
  auto octets = good_message(x, port);
  if (rng.chance(0.5))
    octets.resize(rng.below(peis::data_max + 1), static_cast<std::uint8_t>(rng.next()));
  for (auto changes = rng.below(6); changes > 0 && !octets.empty(); --changes) {
    const std::array values{std::uint8_t{0}, std::uint8_t{0xff}, std::uint8_t{0x80},
                            static_cast<std::uint8_t>(rng.next())};
    octets[rng.below(octets.size())] = values.at(rng.below(values.size()));
  }
  draft form{.type = static_cast<package_type>(rng.below(3)),
             .port = port,
             .destination = x.whom().hub,
             .reliable = rng.chance(0.3)};
  auto header = x.header_of(form, octets.size());
  if (rng.chance(0.5))
    header.destination = rng.chance(0.5) ? any_peer : x.whom().keeper;
  if (rng.chance(0.2))
    header.source = peer_id{static_cast<std::int32_t>(rng.next())};
  if (rng.chance(0.2))
    header.hops = static_cast<std::uint8_t>(rng.next());
  if (rng.chance(0.2))
    header.flags = static_cast<std::uint16_t>(rng.next());
  if (rng.chance(0.1)) {
    header.seqlen = static_cast<std::uint16_t>(rng.below(4));
    header.seqnum = static_cast<std::uint16_t>(rng.below(4));
  }
  if (rng.chance(0.05))
    header.port = static_cast<std::uint16_t>(rng.next());
  x.say_as(header, octets);
}

} // namespace

std::vector<attack_kind> message_attacks() {
  return {
      {"false_acks", "acknowledgements of what nobody has sent", 20000, always(say_false_acks), {}},
      {"never_acks",
       "subscribes to everything and acknowledges nothing",
       5000,
       [](const target& whom) { return std::make_unique<never_acks>(whom); },
       {}},
      {"slow_reader",
       "the same, and never reads its socket",
       5000,
       [](const target& whom) { return std::make_unique<slow_reader>(whom); },
       {}},
      {"trickle_reader",
       "the same, and reads a little now and then",
       5000,
       [](const target& whom) { return std::make_unique<trickle_reader>(whom); },
       {}},
      {"fragments",
       "fragments of messages that never get complete",
       20000,
       always(say_fragment),
       {"limits.fragments_refused", "lost.incomplete"}},
      {"messages", "messages to ports that nobody listens to", 20000, always(say_message), {}},
      {"for_others",
       "packages that are to be passed on to all others",
       42000,
       always(say_for_others),
       {}},
      {"beats", "signs of life, back to back", 42000, always(say_beat), {}},
      {"mutated",
       "packages of every service, with changed octets and lengths",
       20000,
       always(say_mutated),
       {"lost.malformed", "lost.illegal"}},
  };
}

} // namespace rubicon::hostile
