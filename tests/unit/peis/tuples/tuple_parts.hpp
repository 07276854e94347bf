// The classes of a tuple space one by one, of peer `me`, each with the others that it needs.
#pragma once

#include "peis/space/held_tuples.hpp"
#include "peis/space/own_tuples.hpp"
#include "peis/space/subscriber_feed.hpp"
#include "unit/peis/tuples/lone_space.hpp"

namespace rubicon::peis::test {

struct tuple_parts {
  tuple_space_config config;
  instant now = start;
  tuple_clock clock{offset};
  tuple_store store{{config.written_octets_max, config.held_octets_max}};
  tuple_hosts hosts{config.strangers_max, config.stranger_age};
  local_subscriptions local{me, config.subscriptions_max, config.lifetime};
  own_tuples own{config, me, store, hosts, clock};
  held_tuples held{config, me, store, hosts, local, clock};
  subscriber_feed feed{config, me, own, hosts, local, nullptr};

  explicit tuple_parts(tuple_space_config limits = {}) : config(limits) {}

  void subscribe_all() {
    static_cast<void>(
        local.add(prototype(), subscription_id{1}, local_subscriptions::interest::subscription));
  }
  own_change set(std::string_view name, std::string_view text) {
    return *own.set(name_of(name), text_content(text), now).change;
  }
  [[nodiscard]] tuple_pointer stored(peer_id owner, std::string_view name) const {
    return store.content(owner, name_of(name));
  }
};

} // namespace rubicon::peis::test
