// Floods of what every peer of the network must handle: records, routes, broadcasts, queries.
#include <cstdint>

#include "core/codec.hpp"
#include "hostile/attack.hpp"
#include "peis/overlay/network_clock.hpp"
#include "peis/wire/host_query.hpp"
#include "peis/wire/link_url.hpp"
#include "peis/wire/routing_page.hpp"
#include "peis/wire/trace.hpp"

namespace rubicon::hostile {

namespace {

using peis::package_type;

/// Somebody who is not there, with addresses on loopback where nobody listens.
peis::host_record invented(link& x, std::int32_t ids) {
  auto made_up = x.record();
  made_up.id =
      peer_id{static_cast<std::int32_t>(1 + x.rng().below(static_cast<std::uint64_t>(ids)))};
  made_up.magic = x.number();
  made_up.host_name = "nowhere" + std::to_string(made_up.id.value % 100);
  made_up.cluster = made_up.id.value;
  made_up.marked = x.rng().chance(0.5);
  for (std::uint8_t i = 0; i < peis::low_level_addresses_max; ++i)
    made_up.addresses.push_back(peis::tcp_address("lo", true, {127, 0, 0, i}, 1));
  return made_up;
}

void say_host_record(link& x) {
  const auto kind = static_cast<package_type>(x.rng().below(3));
  const peis::host_record_message message{invented(x, 0x7ffffffe), kind != package_type::link};
  const auto to = kind == package_type::direct ? x.whom().hub : any_peer;
  x.say({.type = kind, .port = peis::port::host_record, .destination = to}, encode(message));
}

/// A whole table of 2240 hosts, the own one first; others by chance, so that each one replaces
/// many.
void say_routing_table(link& x) {
  const auto seqno = x.next_seqno();
  std::vector<peis::routing_entry> entries{{x.id, seqno, x.magic, 0, 1}};
  while (entries.size() < peis::routing_pages_max * peis::entries_per_page) {
    const peer_id somebody{static_cast<std::int32_t>(100 + x.rng().below(peer_id_max - 100))};
    entries.push_back(
        {somebody, x.number(), x.number(), static_cast<std::uint8_t>(1 + x.rng().below(28)), 3});
  }
  for (const auto& page : peis::paginate(entries, seqno))
    x.say({.type = package_type::link, .port = peis::port::routing}, encode(page));
}

void say_broadcast(link& x) {
  const bytes octets(64, 0x2a);
  x.say({.type = package_type::broadcast,
         .port = static_cast<std::uint16_t>(peis::port::user_first + x.rng().below(30))},
        octets);
}

/// Times of any size, with more octets than the message has, forwarded and by anybody.
void say_clock(link& x) {
  const duration span = 24h * 365 * 60;
  const peis::clock_message message{x.rng().between(0s, span), x.rng().chance(0.5), 0s};
  auto octets = encode(message);
  octets.resize(octets.size() + x.rng().below(64));
  auto header =
      x.header_of({.type = package_type::broadcast, .port = peis::port::clock}, octets.size());
  header.hops = static_cast<std::uint8_t>(1 + x.rng().below(15));
  x.say_as(header, octets);
}

peer_id anybody_of(link& x) {
  switch (x.rng().below(4)) {
  case 0:
    return x.whom().keeper;
  case 1:
    return x.whom().porch;
  case 2:
    return peer_id{x.number()};
  default:
    return x.whom().hub;
  }
}

void say_question(link& x) {
  const auto to = anybody_of(x);
  if (x.rng().chance(0.5))
    x.say({.port = peis::port::host_query, .destination = to},
          encode(peis::host_query{x.id, peis::any_magic}));
  else
    x.say({.port = peis::port::trace, .destination = to}, encode(peis::trace_message{{x.id}}));
}

} // namespace

std::vector<attack_kind> network_attacks() {
  return {
      {"host_records",
       "records of hosts that are not there",
       27000,
       always(say_host_record),
       {"limits.hosts_refused", "limits.over_budget"}},
      {"routing_tables",
       "whole routing tables, back to back",
       0,
       always(say_routing_table),
       {"limits.tables_put_off", "limits.routes_refused"}},
      {"broadcasts", "small broadcasts", 42000, always(say_broadcast), {}},
      {"clocks", "broadcasts of times that cannot be", 20000, always(say_clock), {}},
      {"questions",
       "traces and host queries",
       20000,
       always(say_question),
       {"lost.no_route", "limits.questions_refused"}},
  };
}

} // namespace rubicon::hostile
