// An island in memory: the cores of a sink and its motes, and a medium that may lose frames.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "communication/interface.hpp"
#include "core/codec.hpp"
#include "mote/crystal.hpp"
#include "mote/node.hpp"
#include "mote/sink.hpp"
#include "support/agenda.hpp"

namespace rubicon::test {

struct island_fixture_config {
  int width = 1; ///< of the grid on which they stand; mote 1, the sink, in a corner
  int height = 1;
  double delivery = 1; ///< chance that a frame arrives, and that its acknowledgement does
  std::uint64_t seed = 1;
  island_id island{1};
  std::optional<mote_id> outsider = {};                    ///< who is played by somebody else
  bool joins_alone = true;                                 ///< else programs call joinIsland
  std::vector<device::transducer_config> transducers = {}; ///< of each mote
  std::vector<island_id> aliases = {};                     ///< of the island
};

/// A sink and motes whose radios reach the eight around them. A unicast is tried four times. Each
/// has its own crystal.
class island_fixture {
public:
  static constexpr mote_id sink_id = default_sink;

  island_fixture(const island_fixture&) = delete; // programs and events point to it
  island_fixture& operator=(const island_fixture&) = delete;

  explicit island_fixture(island_fixture_config config) : config_(config), rng_(config.seed) {
    for (int i = 1; i <= config.width * config.height; ++i) {
      const mote_id id{static_cast<std::uint16_t>(i)};
      if (id != config.outsider)
        start(id);
    }
  }

  /// The first or the next life of a sink or mote.
  void start(mote_id id) {
    auto& here = places_[id];
    here.listens = true;
    here.crystal = mote::crystal(static_cast<std::int64_t>(rng_.below(80'001)) - 40'000);
    const random_stream rng(rng_.next());
    if (id == sink_id) {
      network::router_config network;
      network.self = id;
      mote::registrar_config members;
      members.island = config_.island;
      members.aliases = config_.aliases;
      ++lives_[id];
      here.sink =
          std::make_unique<mote::sink>(network, members, mote::duty_config{}, rng, own_time(id),
                                       mote::gateway_lines_config{}, stores[id]);
      perform(id, here.sink->start(own_time(id)));
      return;
    }
    mote::node_config node;
    node.id = id;
    node.type = 301;
    node.joins_alone = config_.joins_alone;
    node.transducers = config_.transducers;
    here.node = std::make_unique<mote::node>(std::move(node), stores[id], rng, own_time(id));
    ++lives_[id];
    here.app = std::make_unique<program>(*this, id, *here.node);
    perform(id, here.node->start(own_time(id)));
  }

  void kill(mote_id id) { places_.erase(id); }

  mote::node& at(mote_id id) { return *places_.at(id).node; }
  mote::sink& root() { return *places_.at(sink_id).sink; }
  [[nodiscard]] instant now() const { return now_; }
  [[nodiscard]] instant own_time(mote_id id) const { return places_.at(id).crystal.own(now_); }

  /// Those that have joined.
  [[nodiscard]] int joined() const {
    return static_cast<int>(std::ranges::count_if(
        places_, [](const auto& x) { return x.second.node && x.second.node->member().joined(); }));
  }

  /// A program on a mote sends. @returns whether it was accepted
  bool send(mote_id from, mote_address to, std::uint8_t am_type, const bytes& octets,
            bool reliable) {
    auto& here = places_.at(from);
    here.node->begin(own_time(from));
    const auto number = here.app->layer.send_numbered(to, octets, reliable, am_type);
    perform(from, here.node->settle(own_time(from)));
    return number.has_value();
  }

  /// What a core wants to be done.
  template <class Outputs>
  void perform(mote_id who, Outputs todo) {
    for (auto& output : todo)
      std::visit([this, who](auto& x) { this->take(who, x); }, output);
    if (on_performed)
      on_performed(who);
  }

  /// The gateway has written a packet.
  void down(std::uint8_t am_type, byte_view octets) {
    perform(sink_id, root().on_packet(am_type, octets, own_time(sink_id)));
  }

  /// Somebody's radio sends; of the outsider's too the end is told.
  void put_on_air(mote_id from, network::frame_out frame) {
    longest = std::max(longest, frame.payload.size());
    ++frames;
    if (on_air)
      on_air(from, frame);
    const auto wait = rng_.between(1ms, 6ms);
    auto [heard, tries, acked] = delivery_of(from, frame.next_hop);
    if (frame.age_at) {
      byte_writer age;
      age.big(static_cast<std::uint32_t>(wait / 1us));
      std::ranges::copy(age.finish(),
                        frame.payload.begin() + static_cast<std::ptrdiff_t>(*frame.age_at));
    }
    for (const auto to : heard)
      agenda_.add(now_ + wait, [this, from, to, frame] { hear(to, from, frame); });
    agenda_.add(now_ + wait,
                [this, from, life = lives_[from], t = tries, a = acked, token = frame.token] {
                  if (lives_[from] == life) // a new life's radio begins afresh
                    on_sent(from, token, a, t);
                });
  }

  /// A frame arrives, from wherever.
  void hear(mote_id to, mote_id from, const network::frame_out& x) {
    if (to == config_.outsider)
      return to_outsider(from, x);
    const auto found = places_.find(to);
    if (found == places_.end())
      return;
    const auto t = own_time(to);
    if (found->second.sink)
      perform(to, found->second.sink->on_frame(from, x.am_type, x.payload, t, t));
    else
      perform(to, found->second.node->on_frame(from, x.am_type, x.payload, t, t));
  }

  void run_for(duration length) {
    const auto end = now_ + length;
    const auto next = [&] {
      auto due = end;
      for (const auto& [id, x] : places_)
        due = std::min(due, x.crystal.real(x.sink ? x.sink->deadline() : x.node->deadline()));
      return due;
    };
    agenda_.run(now_, end, next, [this] {
      for (auto& [id, x] : places_) {
        if (x.sink)
          perform(id, x.sink->on_time(own_time(id)));
        else
          perform(id, x.node->on_time(own_time(id)));
      }
    });
  }

  /// Runs in steps of 100 ms until `done` holds. @returns whether it does within `limit`
  bool run_until(const std::function<bool()>& done, duration limit) {
    for (const auto end = now_ + limit; !done() && now_ < end;)
      run_for(100ms);
    return done();
  }

  std::vector<std::pair<mote_id, transport::received>> received; ///< by programs, in order
  std::vector<std::pair<mote_id, bool>> outcomes;                ///< of reliable sends: acked?
  std::vector<std::pair<mote_id, mote::membership>> memberships;
  std::vector<mote::to_gateway> up; ///< on the serial line
  std::vector<mote_id> taken;       ///< who is silent, its address being another's
  std::vector<mote::double_refused> doubles;
  std::map<mote_id, mote::nonvolatile> stores; ///< they outlast kill()
  std::size_t longest = 0;                     ///< payload of a frame
  std::size_t frames = 0;

  std::function<void(mote_id)> on_performed; ///< a core has done something
  std::function<void(mote_id from, const network::frame_out&)> on_air; ///< handed to the radio
  std::function<void(mote_id from, const network::frame_out&)> to_outsider = [](auto...) {};
  std::function<void(std::uint64_t token, bool acked, unsigned transmissions)> outsider_sent =
      [](auto...) {};

private:
  /// Takes messages of the types 1 to 15 and writes down what it is told.
  class program final : public communication::communication_events {
  public:
    program(island_fixture& world, mote_id self, mote::node& node)
        : layer(node.attach(*this)), world_(world), self_(self) {
      for (std::uint8_t am_type = 1; am_type < 16; ++am_type)
        static_cast<void>(layer.provide(am_type));
    }

    void receiveFrom(mote_address source, byte_view octets, std::uint8_t am_type) override {
      world_.received.emplace_back(self_, transport::received{source, am_type, to_bytes(octets)});
    }
    void ackOf(std::uint32_t, communication::status success) override {
      world_.outcomes.emplace_back(self_, success == communication::SUCCESS);
    }

    communication::interface layer;

  private:
    island_fixture& world_;
    mote_id self_;
  };

  struct place {
    mote::crystal crystal;
    bool listens = true;
    std::unique_ptr<mote::sink> sink; ///< either this
    std::unique_ptr<program> app;     ///< or this, which outlives
    std::unique_ptr<mote::node> node; ///< this
  };

  struct delivery {
    std::vector<mote_id> heard;
    unsigned tries = 0;
    bool acked = false;
  };

  void take(mote_id who, network::frame_out& x) { put_on_air(who, std::move(x)); }
  void take(mote_id who, const mote::radio_switch& x) { places_.at(who).listens = x.on; }
  void take(mote_id, mote::to_gateway& x) { up.push_back(std::move(x)); }
  void take(mote_id who, mote::membership& x) { memberships.emplace_back(who, x); }
  void take(mote_id, const mote::actuator_arrived&) {}
  void take(mote_id who, mote::address_taken) { taken.push_back(who); }
  void take(mote_id, const mote::double_refused& x) { doubles.push_back(x); }
  void take(mote_id who, const mote::store_nonvolatile& x) { stores[who] = x.content; }

  [[nodiscard]] bool is_there(mote_id id) const {
    const auto found = places_.find(id);
    return found == places_.end() ? id == config_.outsider : found->second.listens;
  }

  [[nodiscard]] bool near(mote_id a, mote_id b) const {
    const int ia = a.value - 1;
    const int ib = b.value - 1;
    return a != b && std::abs(ia % config_.width - ib % config_.width) <= 1 &&
           std::abs(ia / config_.width - ib / config_.width) <= 1;
  }

  delivery delivery_of(mote_id from, mote_id to) {
    delivery x;
    if (to == broadcast_mote) {
      for (int i = 1; i <= config_.width * config_.height; ++i) {
        const mote_id id{static_cast<std::uint16_t>(i)};
        if (is_there(id) && near(from, id) && rng_.chance(config_.delivery))
          x.heard.push_back(id);
      }
      x.tries = 1;
      x.acked = true; // it has left the radio
      return x;
    }
    const bool reachable = is_there(to) && near(from, to);
    while (x.tries < 4 && !x.acked) {
      ++x.tries;
      if (!reachable || !rng_.chance(config_.delivery))
        continue;
      x.heard = {to}; // copies are the medium access's to drop
      x.acked = rng_.chance(config_.delivery);
    }
    return x;
  }

  void on_sent(mote_id who, std::uint64_t token, bool acked, unsigned tries) {
    if (who == config_.outsider)
      return outsider_sent(token, acked, tries);
    const auto found = places_.find(who);
    if (found == places_.end())
      return;
    if (found->second.sink)
      perform(who, found->second.sink->on_sent(token, acked, tries, own_time(who)));
    else
      perform(who, found->second.node->on_sent(token, acked, tries, own_time(who)));
  }

  island_fixture_config config_;
  random_stream rng_;
  instant now_;
  std::map<mote_id, place> places_;
  std::map<mote_id, std::uint32_t> lives_;
  agenda agenda_;
};

} // namespace rubicon::test
