// Two islands with their gateways, and two PCs: every place where a program of the Communication
// Layer can be, a gateway's PC among them, and beside its mote, in an actor of its own.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "communication/interface.hpp"
#include "communication/pc.hpp"
#include "gateway/gateway.hpp"
#include "network/am.hpp"
#include "support/agenda.hpp"
#include "support/island_fixture.hpp"
#include "support/recorder.hpp"
#include "support/remote_program.hpp"
#include "support/seeds.hpp"

namespace rubicon::test {

struct placements_config {
  double frame_delivery = 1;
  double message_delivery = 1; ///< of messages between peers
  std::uint64_t seed = 1;
};

/// Island 1 is a line of seven motes, island 2 one of three; the sinks are the first. The PCs are
/// the peers 20 and 21.
class placements_fixture {
public:
  explicit placements_fixture(placements_config config = {})
      : config_(config),
        rng_(config.seed), islands_{std::make_unique<island_fixture>(
                                        island_fixture_config{.width = 7,
                                                              .delivery = config.frame_delivery,
                                                              .seed = config.seed,
                                                              .island = island_id{1}}),
                                    std::make_unique<island_fixture>(
                                        island_fixture_config{.width = 3,
                                                              .delivery = config.frame_delivery,
                                                              .seed = config.seed + 1,
                                                              .island = island_id{2}})} {
    for (std::uint32_t i = 1; i <= 2; ++i) {
      gateways_.emplace(peer_id(static_cast<std::int32_t>(i)),
                        gateway::gateway({.island = island_id(i)}, random_stream(rng_.next())));
      perform(island_id(i), gateway_at(island_id(i)).on_clock(0s, now_));
      perform(island_id(i), gateway_at(island_id(i)).start(now_));
    }
    for (const auto id : {20, 21})
      start_pc(peer_id(id));
    for (std::uint32_t i = 1; i <= 2; ++i)
      island(island_id(i)).on_performed = [this, i](mote_id x) { exchange({island_id(i), x}); };
  }

  /// The first or, after kill(), the next life of a PC.
  void start_pc(peer_id id) {
    communication::pc_config config;
    config.self = id;
    config.incarnation = lives_[id]++;
    pcs_[id] = communication::pc(config, random_stream(rng_.next()));
    perform(id, pcs_[id].start(now_));
  }

  /// All are members and have the time; everybody knows where everybody is.
  [[nodiscard]] bool settle() {
    const bool all_joined = run_until(
        [this] { return islands_[0]->root().members() == 6 && islands_[1]->root().members() == 2; },
        3min);
    run_for(1min);
    return all_joined;
  }

  [[nodiscard]] instant now() const { return now_; }
  [[nodiscard]] island_fixture& island(island_id x) { return *islands_[x.value - 1]; }
  [[nodiscard]] communication::pc& pc(island_id x) { return pcs_.at(gateway_of(x)); }
  [[nodiscard]] gateway::gateway& gateway_at(island_id x) { return gateways_.at(gateway_of(x)); }

  /// A program at a mote or, with no_mote, at a gateway or another PC. @param x outlives this world
  /// @param beside a mote, not at it
  void attach(mote_address where, recorder& x, bool beside = false) {
    if (beside) {
      auto& added = beside_[where].emplace_back(
          std::make_unique<remote_program>(island(where.island).at(where.mote), x));
      x.layer = added->layer;
      exchange(where);
      return;
    }
    if (is_gateway(where))
      x.layer = gateway_at(where.island).attach(x);
    else
      x.layer =
          is_pc(where) ? pc(where.island).attach(x) : island(where.island).at(where.mote).attach(x);
  }

  [[nodiscard]] const communication::layer& layer_of(mote_address x) {
    if (is_gateway(x))
      return gateway_at(x.island).pc().above();
    return is_pc(x) ? pc(x.island).above() : island(x.island).at(x.mote).above();
  }

  /// A program there gives commands now. @returns what `commands` does
  template <class Commands>
  auto act(mote_address where, Commands commands) {
    if (is_gateway(where)) {
      auto& here = gateway_at(where.island);
      here.begin(now_);
      const auto result = commands();
      perform(where.island, here.flush());
      return result;
    }
    if (is_pc(where)) {
      auto& here = pc(where.island);
      here.begin(now_);
      const auto result = commands();
      perform(gateway_of(where.island), here.flush());
      return result;
    }
    for (auto& x : beside_[where])
      x->process.begin(island(where.island).own_time(where.mote));
    return at_mote(where, commands);
  }

  /// No goodbye. Its programs must not give commands any more.
  void kill(mote_address x) {
    beside_.erase(x);
    if (is_gateway(x))
      gateways_.erase(gateway_of(x.island));
    else if (is_pc(x))
      pcs_.erase(gateway_of(x.island));
    else
      island(x.island).kill(x.mote);
  }

  void run_for(duration length) {
    for (const auto end = now_ + length; now_ < end;)
      step();
  }

  bool run_until(const std::function<bool()>& done, duration limit) {
    for (const auto end = now_ + limit; !done() && now_ < end;)
      run_for(100ms);
    return done();
  }

  std::size_t messages_between_peers = 0;
  std::map<std::pair<island_id, std::string>, bytes> tuples; ///< of gateways, by key

private:
  static constexpr duration step_length = 4ms;

  [[nodiscard]] static bool is_gateway(mote_address x) {
    return x.mote == no_mote && x.island.value <= 2;
  }
  [[nodiscard]] static bool is_pc(mote_address x) { return x.mote == no_mote && !is_gateway(x); }

  template <class Commands>
  auto at_mote(mote_address where, Commands commands) {
    auto& around = island(where.island);
    auto& here = around.at(where.mote);
    here.begin(around.own_time(where.mote));
    const auto result = commands();
    around.perform(where.mote, here.settle(around.own_time(where.mote)));
    return result;
  }

  /// Programs beside a mote and the mote hear of each other.
  void exchange(mote_address where) {
    const auto here = beside_.find(where);
    if (here == beside_.end())
      return;
    for (auto& x : here->second) {
      x->exchange(island(where.island).own_time(where.mote), [&](auto commands) {
        at_mote(where, [&] {
          commands();
          return 0;
        });
      });
    }
  }

  void step() {
    for (std::uint32_t i = 1; i <= 2; ++i) {
      auto& here = island(island_id(i));
      here.run_for(step_length);
      for (auto& x : std::exchange(here.up, {})) {
        if (const auto gate = gateways_.find(gateway_of(island_id(i))); gate != gateways_.end())
          perform(island_id(i), gate->second.on_packet(x.source, x.am_type, x.payload, here.now()));
      }
    }
    const auto end = now_ + step_length;
    agenda_.run(
        now_, end, [end] { return end; }, [] {});
    for (auto& [id, x] : gateways_)
      perform(island_id(static_cast<std::uint32_t>(id.value)), x.on_time(now_));
    for (auto& [id, x] : pcs_)
      perform(id, x.on_time(now_));
  }

  void perform(island_id from, gateway::outputs todo) {
    for (auto& x : todo) {
      if (auto* packet = std::get_if<gateway::to_sink>(&x)) {
        agenda_.add(now_ + 1ms, [this, from, y = std::move(*packet)] {
          island(from).down(y.am_type, y.payload);
        });
      } else if (const auto* event = std::get_if<gateway::answer_sink>(&x)) {
        agenda_.add(now_ + 1ms, [this, from, y = encode(event->answer)] {
          island(from).down(network::am::sink_event, y);
        });
      } else if (auto* message = std::get_if<gateway::to_gateway>(&x)) {
        post(gateway_of(from), message->peer, std::move(message->octets));
      } else if (auto* tuple = std::get_if<gateway::publish>(&x)) {
        tuples[{from, tuple->key}] = std::move(tuple->value);
      } else if (const auto* gone = std::get_if<gateway::erase>(&x)) {
        tuples.erase({from, gone->key});
      }
    }
  }

  void perform(peer_id from, communication::outputs todo) {
    for (auto& x : todo) {
      auto message = communication::message_of(std::move(x));
      post(from, message.peer, std::move(message.octets));
    }
  }

  void post(peer_id from, peer_id to, bytes octets) {
    ++messages_between_peers;
    if (!rng_.chance(config_.message_delivery))
      return;
    agenda_.add(now_ + 3ms, [this, from, to, x = std::move(octets)] {
      if (const auto gate = gateways_.find(to); gate != gateways_.end())
        perform(island_id(static_cast<std::uint32_t>(to.value)),
                gate->second.on_message(from, communication::island_message_port, x, now_));
      else if (const auto pc = pcs_.find(to); pc != pcs_.end())
        perform(to, pc->second.on_message(from, x, now_));
    });
  }

  placements_config config_;
  random_stream rng_;
  instant now_;
  std::array<std::unique_ptr<island_fixture>, 2> islands_;
  std::map<peer_id, gateway::gateway> gateways_;
  std::map<peer_id, communication::pc> pcs_;
  std::map<peer_id, std::uint32_t> lives_; ///< of PCs
  std::map<mote_address, std::vector<std::unique_ptr<remote_program>>> beside_;
  agenda agenda_;
};

/// Where the two ends of a test are (PAR-01..03).
struct placement {
  const char* name;
  mote_address from;
  mote_address to;
  bool beside = false; ///< programs of motes are in actors of their own
};

inline constexpr std::array placements{
    placement{"two motes of an island, five hops apart",
              {island_id{1}, mote_id{7}},
              {island_id{1}, mote_id{2}}},
    placement{"motes of two islands", {island_id{1}, mote_id{6}}, {island_id{2}, mote_id{3}}},
    placement{"a PC and a mote", {island_id{20}, no_mote}, {island_id{1}, mote_id{4}}},
    placement{"a mote and a PC", {island_id{2}, mote_id{3}}, {island_id{21}, no_mote}},
    placement{"two PCs", {island_id{20}, no_mote}, {island_id{21}, no_mote}},
    placement{"a mote and its gateway", {island_id{1}, mote_id{7}}, {island_id{1}, no_mote}},
    placement{"a gateway and a mote of another island",
              {island_id{1}, no_mote},
              {island_id{2}, mote_id{3}}},
    placement{"a PC and a gateway", {island_id{20}, no_mote}, {island_id{2}, no_mote}},
    placement{"two motes of an island, each beside its program",
              {island_id{1}, mote_id{7}},
              {island_id{1}, mote_id{2}},
              true},
    placement{"motes of two islands, each beside its program",
              {island_id{1}, mote_id{6}},
              {island_id{2}, mote_id{3}},
              true},
};

inline constexpr auto placements_max = static_cast<unsigned>(placements.size());

/// An end that is a PC has its program at it in any case.
inline void attach(placements_fixture& world, const placement& x, recorder& from, recorder& to) {
  world.attach(x.from, from, x.beside && x.from.mote != no_mote);
  world.attach(x.to, to, x.beside && x.to.mote != no_mote);
}

/// From one that is tested to the next: each third where each run is twenty times as slow.
inline constexpr unsigned placements_step = seeds(3) == 1 ? 3 : 1;

} // namespace rubicon::test
