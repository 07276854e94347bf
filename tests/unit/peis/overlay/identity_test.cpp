// Two peers with one id, and a neighbour of both (RTE-08, IF-12).
#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "peis/kernel/kernel.hpp"
#include "support/catch.hpp"
#include "unit/peis/fixture.hpp"

namespace rubicon::peis::test {
namespace {

/// One peer in the middle to which all others keep a link. Other than in a world, peers have places
/// in place of ids to tell them apart.
class meeting {
public:
  static constexpr std::size_t middle = 0;

  explicit meeting(std::uint64_t seed) : seed_(seed) { add(1); }

  std::size_t add(std::int32_t id) {
    auto config = config_of(id);
    config.network.name = "place" + std::to_string(places_.size());
    if (!places_.empty())
      config.network.connections.always = {"inproc://1"};
    places_.push_back({kernel(config, random_stream(seed_, config.network.name), now_), {}, true});
    return places_.size() - 1;
  }

  /// Ends without a word; its links are reset.
  void remove(std::size_t place) {
    places_[place].alive = false;
    for (const auto& [link, other] : std::map(ends_)) {
      if (other == place)
        end(link, middle);
    }
  }

  /// Loses its power: nobody is told.
  void vanish(std::size_t place) { places_[place].alive = false; }

  void run_for(duration length) {
    for (const auto until = now_ + length; now_ < until; now_ += 10ms) {
      for (auto calls = std::exchange(calls_, {}); !calls.empty(); calls.pop_front())
        calls.front()();
      for (std::size_t i = 0; i < places_.size(); ++i) {
        if (const auto due = places_[i].peer.deadline(); places_[i].alive && due && *due <= now_)
          perform(i, places_[i].peer.on_time(now_));
      }
    }
  }

  kernel& at(std::size_t place) { return places_[place].peer; }
  [[nodiscard]] const std::vector<id_taken>& told(std::size_t place) { return places_[place].told; }

  [[nodiscard]] std::size_t tellings_to_leave(std::size_t place) {
    return static_cast<std::size_t>(std::ranges::count_if(
        told(place), [](const auto& x) { return x.stays_away > duration(0); }));
  }

private:
  struct occupant {
    kernel peer;
    std::vector<id_taken> told;
    bool alive = true;
  };

  void end(link_id link, std::size_t heard_by) {
    if (ends_.erase(link) > 0 && places_[heard_by].alive)
      calls_.push_back([=, this] { perform(heard_by, at(heard_by).on_link_closed(link, now_)); });
  }

  void open(std::size_t from, attempt_id attempt) {
    const link_id link{next_link_++};
    ends_[link] = from;
    perform(middle, at(middle).on_link_open(link, link_role::acceptor, now_));
    perform(from, at(from).on_link_open(link, link_role::initiator, now_, attempt));
  }

  void perform(std::size_t from, const outputs& todo) {
    for (const auto& x : todo) {
      if (const auto* octets = std::get_if<to_link>(&x)) {
        calls_.push_back([=, this, octets = *octets] {
          const auto owner = ends_.find(octets.link);
          const auto to = owner == ends_.end() ? from : from == middle ? owner->second : middle;
          if (to != from && places_[to].alive)
            perform(to, at(to).on_link_octets(octets.link, octets.octets.view(), now_));
        });
      } else if (const auto* closed = std::get_if<close_link>(&x)) {
        calls_.push_back([=, this, link = closed->link] {
          if (const auto owner = ends_.find(link); owner != ends_.end())
            end(link, from == middle ? owner->second : middle);
        });
      } else if (const auto* wish = std::get_if<connect_to>(&x)) {
        calls_.push_back([=, this, attempt = wish->attempt] {
          if (places_[from].alive)
            open(from, attempt);
        });
      } else if (const auto* taken = std::get_if<id_taken>(&x)) {
        places_[from].told.push_back(*taken);
      }
    }
  }

  std::uint64_t seed_;
  instant now_{};
  std::deque<occupant> places_;
  std::map<link_id, std::size_t> ends_; ///< whose link to the middle
  std::uint64_t next_link_ = 1;
  std::deque<std::function<void()>> calls_;
};

} // namespace

TEST_CASE("a newcomer leaves a used id, both are told, and takes it over when it is free",
          "[peis][RTE-08][IF-12][ADR-02]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) { // either may have the higher magic number
    CAPTURE(seed);
    meeting x(seed);
    const auto first = x.add(5);
    x.run_for(1min);
    const auto second = x.add(5);
    x.run_for(5min);
    CHECK(!x.told(first).empty());
    CHECK(!x.told(second).empty());
    CHECK(x.tellings_to_leave(first) == 0);
    CHECK(x.tellings_to_leave(second) >= 1);
    CHECK(x.tellings_to_leave(second) <= 6);
    CHECK(x.at(first).counters().network.links_opened == 1); // nothing disturbed it
    CHECK(x.at(meeting::middle).reader().find(peer_id{1}, "kernel.id-taken") == nullptr);
    CHECK(x.at(second).reader().find(peer_id{5}, "kernel.id-taken") != nullptr);
    x.remove(first);
    x.run_for(2min + 30s);
    CHECK(x.at(second).network().reachable(peer_id{1}));
    CHECK(x.at(meeting::middle).network().knows_present(peer_id{5}));
  }
}

TEST_CASE("of two that come at once one stays", "[peis][RTE-08][IF-12]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    meeting x(seed);
    const auto a = x.add(5);
    const auto b = x.add(5);
    x.run_for(3min);
    CHECK((x.tellings_to_leave(a) == 0) != (x.tellings_to_leave(b) == 0));
    CHECK(x.at(meeting::middle).network().knows_present(peer_id{5}));
    CHECK(x.at(meeting::middle).counters().network.links_opened < 40);
  }
}

TEST_CASE("a restart is no rival, whenever it comes", "[peis][RTE-08]") {
  const bool powered = GENERATE(false, true);
  for (const auto gap : {10ms, 500ms, 1000ms, 3000ms}) {
    CAPTURE(powered, gap.count());
    meeting x(7);
    const auto first = x.add(5);
    x.run_for(1min);
    if (powered)
      x.remove(first);
    else
      x.vanish(first);
    x.run_for(gap);
    const auto second = x.add(5);
    x.run_for(5s);
    CHECK(x.told(second).empty());
    CHECK(x.at(meeting::middle).network().knows_present(peer_id{5}));
    CHECK(x.at(second).network().reachable(peer_id{1}));
  }
}

} // namespace rubicon::peis::test
