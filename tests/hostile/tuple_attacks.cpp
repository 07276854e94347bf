// Floods of what tuple spaces must handle: tuples, subscriptions, appends, meta tuples.
#include <algorithm>
#include <cstdint>

#include "hostile/attack.hpp"
#include "peis/tuples/meta_tuple.hpp"
#include "peis/tuples/tuple_record.hpp"

namespace rubicon::hostile {

namespace {

constexpr std::size_t big_size = 10'000'000;

peis::key key_of(const std::string& text) {
  return *peis::key::parse(text);
}

/// A set message for the hub, or a push of our own tuple to it. The value is to follow.
bytes tuple_head(link& x, peis::tuple_message_kind kind, const std::string& name) {
  peis::tuple t;
  t.owner = kind == peis::tuple_message_kind::set ? x.whom().hub : x.id;
  t.creator = x.id;
  t.name = key_of(name);
  t.written = {1'000'000'000, 0};
  return encode_tuple_head(t, kind);
}

void set(link& x, const std::string& name, std::size_t size) {
  x.begin({.port = peis::port::set, .destination = x.whom().hub, .reliable = true},
          tuple_head(x, peis::tuple_message_kind::set, name), size);
}

void push(link& x, const std::string& name, std::size_t size) {
  x.begin({.port = peis::port::push, .destination = x.whom().hub, .reliable = true},
          tuple_head(x, peis::tuple_message_kind::push, name), size);
}

void subscribe(link& x, peer_id at, const peis::prototype& wanted) {
  x.begin({.port = peis::port::subscribe, .destination = at, .reliable = true},
          encode(peis::subscribe_message{wanted, peis::lifetime_tag{}}));
}

std::string numbered(link& x, const char* head) {
  return head + std::to_string(x.index()) + "-" + std::to_string(x.next_seqno());
}

/// The hub gets some tuples to push; then the same subscription to all of them again and again.
class equal_subscriptions : public attack {
public:
  using attack::attack;

  void say(link& x) override {
    if (x.said_since_open < tuples_first)
      return set(x, numbered(x, "heap."), 400);
    subscribe(x, whom().hub, peis::prototype_of(any_peer, {}));
  }
  void hear(link&, const peis::received_package&) override {} // nothing is acknowledged

private:
  static constexpr std::uint64_t tuples_first = 300;
};

void say_subscription(link& x) {
  auto wanted = peis::prototype_of(x.whom().hub, key_of(numbered(x, "wish.")));
  if (x.rng().chance(0.2))
    wanted.name = key_of(numbered(x, "*.wish"));
  subscribe(x, x.rng().chance(0.8) ? x.whom().hub : x.whom().keeper, wanted);
}

/// Subscribers who are not there, each of them once.
void say_ghost_subscription(link& x) {
  const auto who = peer_id{x.number()};
  x.say({.port = peis::port::subscribe,
         .source = who,
         .destination = x.rng().chance(0.5) ? x.whom().hub : x.whom().keeper,
         .reliable = true},
        encode(peis::subscribe_message{peis::prototype_of(any_peer, {}), peis::lifetime_tag{}}));
}

void say_tuple(link& x) {
  if (x.rng().chance(0.5))
    set(x, numbered(x, "heap."), 40);
  else
    push(x, numbered(x, "hoard."), 40); // which the hub collects
}

/// The same few tuples, each time longer or shorter.
void say_changed_tuple(link& x) {
  const auto name = "hoard.c" + std::to_string(x.rng().below(20));
  set(x, name, 1 + x.rng().below(700));
}

/// Values of 10 MB, half of them the hub's own, half of them ours; then the link ends.
class big_tuples : public attack {
public:
  using attack::attack;

  void say(link& x) override {
    if (x.said_since_open > 2 + 20 * (big_size / peis::data_max))
      return x.drop(false);
    if (x.rng().chance(0.5))
      set(x, numbered(x, "heap."), big_size);
    else
      push(x, numbered(x, "hoard."), big_size);
  }
};

/// Each link subscribes to one tuple of the hub's, and adds to all of them.
class appends : public attack {
public:
  using attack::attack;

  void say(link& x) override {
    const auto mine = "heap.a" + std::to_string(x.index() % 8);
    if (x.said_since_open < 3)
      return set(x, mine, 1);
    if (x.said_since_open < 4)
      return subscribe(x, whom().hub, peis::prototype_of(whom().hub, key_of("heap.*")));
    auto octets = peis::encode_append_request_head(
        {peis::prototype_of(whom().hub, key_of("heap.*")), payload(bytes(added, 'x'))});
    octets.resize(octets.size() + added, 'x');
    x.begin({.port = peis::port::append_request, .destination = whom().hub, .reliable = true},
            std::move(octets));
  }

private:
  static constexpr std::size_t added = 700;
};

/// Each link has a dozen long tuples at the hub for itself, changes them all the time and
/// subscribes to them: what waits for one link is shared with no other. Nothing is acknowledged.
class deaf_subscribers : public attack {
public:
  using attack::attack;

  void say(link& x) override {
    const auto mine = "heap.d" + std::to_string(x.index()) + "-";
    if (x.said_since_open < 3 + own_tuples)
      return subscribe(
          x, whom().hub,
          peis::prototype_of(whom().hub,
                             key_of(mine + std::to_string(x.said_since_open % own_tuples))));
    set(x, mine + std::to_string(x.rng().below(own_tuples)), size);
  }
  void hear(link&, const peis::received_package&) override {}

private:
  static constexpr std::uint64_t own_tuples = 12;
  static constexpr std::size_t size = 100'000;
};

/// Points the fan's input hither and thither, and many inputs that nobody has.
void say_meta_tuple(link& x) {
  const auto name =
      x.rng().chance(0.7) ? std::string("kitchen.fan.mi-switch") : numbered(x, "heap.mi-");
  const peis::meta_target there{peer_id{x.number()}, key_of(numbered(x, "wish."))};
  peis::tuple t;
  t.owner = x.whom().keeper;
  t.creator = x.id;
  t.name = key_of(name);
  t.mimetype = peis::meta_mimetype;
  t.value = peis::meta_content(there).value;
  auto octets = encode_tuple_head(t, peis::tuple_message_kind::set);
  octets.insert(octets.end(), t.value.view().begin(), t.value.view().end());
  x.begin({.port = peis::port::set, .destination = t.owner, .reliable = true}, std::move(octets));
}

} // namespace

std::vector<attack_kind> tuple_attacks() {
  return {
      {"equal_subscriptions",
       "one subscription to everything, again and again",
       20000,
       [](const target& whom) { return std::make_unique<equal_subscriptions>(whom); },
       {}},
      {"subscriptions",
       "distinct subscriptions, 100 000 and more",
       20000,
       always(say_subscription),
       {}},
      {"ghost_subscribers",
       "subscriptions to everything, by peers that are not there",
       20000,
       always(say_ghost_subscription),
       {"limits.strangers", "limits.subscriptions_full"}},
      {"changed_tuples",
       "a few tuples of the hub's, changed all the time",
       20000,
       always(say_changed_tuple),
       {}},
      {"tuples", "many small tuples, the hub's and our own", 20000, always(say_tuple), {}},
      {"big_tuples",
       "tuples of 10 MB, whose writers leave",
       0,
       [](const target& whom) { return std::make_unique<big_tuples>(whom); },
       {}},
      {"appends",
       "appends to a few tuples with subscribers",
       20000,
       [](const target& whom) { return std::make_unique<appends>(whom); },
       {"limits.appends_refused"}},
      {"deaf_subscribers",
       "long tuples that change, whose subscribers acknowledge nothing",
       0,
       [](const target& whom) { return std::make_unique<deaf_subscribers>(whom); },
       {}},
      {"meta_tuples",
       "meta tuples that point hither and thither",
       5000,
       always(say_meta_tuple),
       {}},
  };
}

} // namespace rubicon::hostile
