// Lies: about ways, about who somebody is, about who is dead.
#include <array>

#include "hostile/attack.hpp"
#include "peis/wire/dead_host.hpp"
#include "peis/wire/routing_page.hpp"

namespace rubicon::hostile {

namespace {

using peis::package_type;

peer_id victim_of(link& x) {
  const std::array all{peer_id{1}, x.whom().hub, x.whom().keeper, x.whom().porch,
                       x.whom().bystander};
  return all.at(x.rng().below(all.size()));
}

/// We are as near to everybody as can be, and always know the newest.
void say_false_routes(link& x) {
  peis::routing_page page;
  page.seqno = x.next_seqno();
  page.entries.push_back({x.id, page.seqno, x.magic, 0, 1});
  for (const auto who :
       {peer_id{1}, x.whom().hub, x.whom().keeper, x.whom().porch, x.whom().bystander})
    page.entries.push_back({who, static_cast<std::int32_t>(0x7fffffff - x.rng().below(1000)),
                            x.rng().chance(0.5) ? x.magic : x.number(),
                            static_cast<std::uint8_t>(x.rng().below(2) * x.rng().below(256)), 1});
  x.say({.type = package_type::link, .port = peis::port::routing}, encode(page));
}

/// Its links claim ids of others, and its records new lives of them.
class impostors : public attack {
public:
  using attack::attack;

  void open(link& x) override {
    x.id = victim_of(x);
    x.magic = x.number();
    x.greet();
  }

  void say(link& x) override {
    auto record = x.record();
    record.id = victim_of(x);
    record.magic = x.number();
    const auto kind = static_cast<package_type>(x.rng().below(3));
    x.say({.type = kind,
           .port = peis::port::host_record,
           .source = record.id,
           .destination = kind == package_type::direct ? whom().hub : any_peer},
          encode(peis::host_record_message{record, x.rng().chance(0.5)}));
  }
};

/// The living are dead, says somebody, or they themselves.
void say_dead(link& x) {
  const auto who = victim_of(x);
  const auto kind = x.rng().chance(0.5) ? package_type::broadcast : package_type::direct;
  const auto why = static_cast<peis::dead_host_message::reason>(x.rng().below(3));
  draft message{.type = kind, .port = peis::port::dead_host};
  if (kind == package_type::direct)
    message.destination = x.rng().chance(0.5) ? x.whom().hub : x.whom().keeper;
  if (x.rng().chance(0.7))
    message.source = who;
  x.say(message, encode(peis::dead_host_message{who, why}));
}

} // namespace

std::vector<attack_kind> identity_attacks() {
  return {
      {"false_routes",
       "routes that lie: metric 0, other lives, newest numbers",
       500,
       always(say_false_routes),
       {}},
      {"impostors",
       "links and records under the ids of others",
       500,
       [](const target& whom) { return std::make_unique<impostors>(whom); },
       {}},
      {"dead_claims", "living hosts are said to be dead", 500, always(say_dead), {}},
  };
}

} // namespace rubicon::hostile
