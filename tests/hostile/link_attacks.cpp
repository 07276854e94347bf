// What links alone can do: take all places, come and go, say nothing or nonsense.
#include "hostile/attack.hpp"

namespace rubicon::hostile {

namespace {

/// Connected, and never a word. Nor do they go.
class idle_links : public attack {
public:
  using attack::attack;
  void open(link&) override {}
  void say(link&) override {}
};

/// Good neighbours, but for their number.
class link_holders : public attack {
public:
  using attack::attack;
  void open(link& x) override { x.greet(4); }
  void say(link& x) override { x.beat(); }
};

/// A part of the request, an octet now and then.
class slow_greeters : public attack {
public:
  using attack::attack;
  void open(link&) override {}
  void say(link& x) override { x.say_octets(bytes(1, 0)); }
};

/// Comes, greets and goes: by an end or by a reset, sometimes before the greeting is complete.
class churn : public attack {
public:
  using attack::attack;
  void open(link& x) override {
    x.id = peer_id{static_cast<std::int32_t>(1000 + x.rng().below(60000))};
    x.magic = x.number();
    if (x.rng().chance(0.8))
      x.greet(x.rng().chance(0.5) ? 4 : 0);
  }
  void say(link& x) override {
    if (x.waiting() == 0 || x.rng().chance(0.2))
      x.drop(x.rng().chance(0.5));
  }
  [[nodiscard]] duration reopened_after() const override { return 0ms; }
};

/// Greets, and then says what is no package.
class garbage : public attack {
public:
  using attack::attack;
  void open(link& x) override {
    if (x.rng().chance(0.7))
      x.greet();
  }
  void say(link& x) override {
    bytes octets(1 + x.rng().below(4000));
    for (auto& octet : octets)
      octet = static_cast<std::uint8_t>(x.rng().next());
    x.say_octets(octets);
  }
};

template <class T>
std::function<std::unique_ptr<attack>(const target&)> made() {
  return [](const target& whom) { return std::make_unique<T>(whom); };
}

} // namespace

std::vector<attack_kind> link_attacks() {
  return {
      {"idle_links",
       "links that never greet",
       1,
       made<idle_links>(),
       {"links_closed.handshake_silent", "limits.greetings_evicted"},
       true},
      {"slow_greeters",
       "greetings of an octet now and then",
       64,
       made<slow_greeters>(),
       {"links_closed.handshake_silent", "limits.greetings_evicted"},
       true},
      {"link_holders",
       "links that greet, live and want nothing",
       64,
       made<link_holders>(),
       {"links_closed.too_many_links", "limits.newcomers_referred"},
       true},
      {"churn", "links that come and go", 2000, made<churn>(), {"links_closed.far_end"}},
      {"garbage",
       "octets that are no packages",
       2000,
       made<garbage>(),
       {"links_closed.bad_stream"}},
  };
}

std::size_t crowd_of(const attack_kind& kind, std::size_t links) {
  constexpr std::size_t many = 64; // all the links that a peer takes
  return kind.crowd && links >= many ? 3 * links : links;
}

const std::vector<attack_kind>& all_attacks() {
  static const auto all = [] {
    std::vector<attack_kind> x;
    for (auto part : {network_attacks(), identity_attacks(), tuple_attacks(), message_attacks(),
                      link_attacks()})
      x.insert(x.end(), part.begin(), part.end());
    return x;
  }();
  return all;
}

} // namespace rubicon::hostile
