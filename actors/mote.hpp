// A mote: its communication layer, its radio client, its transducers, and the apps that run on it.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "actors/flow_host.hpp"
#include "actors/messages.hpp"
#include "actors/program_host.hpp"
#include "actors/timer.hpp"
#include "config/ecology.hpp"
#include "mote/crystal.hpp"
#include "mote/node.hpp"
#include "mote/nonvolatile.hpp"
#include "mote/program_port.hpp"
#include "mote/walk.hpp"

namespace rubicon {

/// What a mote actor is made of, the same in all its lives.
struct mote_arguments {
  mote_address address;
  std::string name; ///< `kitchen/climate-7`
  config::stack stack = config::stack::full;
  mote::node_config node; ///< full stack only
  mote::crystal crystal;
  std::vector<config::mote_app> apps;
  std::vector<mote::way_point> path; ///< empty: it does not move
  duration step = 1s;                ///< of its moves
  std::uint64_t seed = 0;            ///< of the ecology
  radio::radio_index radio;
  air_actor air;
  ecology_actor ecology;
};

struct mote_state;

/// An app that is an actor of its own, as the mote's layer sees it.
class app_port final : public mote::communication_events {
public:
  using mote_pointer = scheduler::traced_pointer<mote_state, mote_actor>;

  /// @param self has a node
  app_port(mote_pointer self, mote_app_actor app);

  [[nodiscard]] bool claim(std::uint8_t am_type); ///< false: it is another's
  void send(const send_message& x);

  void receiveFrom(mote_address source, byte_view octets, std::uint8_t am_type) override;
  void ackOf(std::uint32_t number, mote::status success) override;
  void outputsWanted(std::span<const mote::output_wanted> all) override;
  [[nodiscard]] bool wants_ticks() const override { return false; }

  [[nodiscard]] const mote_app_actor& app() const { return app_; }

private:
  mote_pointer self_;
  mote_app_actor app_;
  mote::communication layer_;
  std::map<std::uint32_t, std::uint64_t> tokens_; ///< of reliable sends
};

/// A program in an actor of its own, as the mote sees it.
struct separate_program {
  program_client_actor actor;
  std::unique_ptr<mote::program_port> port;
};

struct mote_state {
  static constexpr std::uint8_t walk_timer = 2;
  static constexpr std::uint8_t last_words_timer = 3;

  std::shared_ptr<const mote_arguments> arguments;
  mote::crystal crystal;          ///< as the clock of this life shows it
  mote::nonvolatile store;        ///< as it was before this life
  std::optional<mote::node> node; ///< full stack only
  flow_host flows;
  mote::walk walk;
  timer wake;
  timer walk_wake{walk_timer};
  timer last_words{last_words_timer}; ///< until the fault plan's end of the battery
  std::vector<mote_app_actor> apps;
  std::vector<std::unique_ptr<app_port>> ports;
  program_host programs;
  std::map<std::uint32_t, separate_program> separate; ///< by number
  std::map<std::string, mote_app_actor> movers;       ///< who has set which actuator last
  bool flat = false;
  std::uint64_t offered_in_vain = 0; ///< messages of apps that had not heard that it is flat
};

/// Spawns the mote's apps and, with the full stack, lets it join its island. Apps end with it. An
/// exception in a handler ends the mote; its supervisor starts it again (ACT-03).
/// @param arguments not nullptr
/// @param store as earlier lives have written it
mote_actor::behavior_type mote_behavior(scheduler::traced_pointer<mote_state, mote_actor> self,
                                        std::shared_ptr<const mote_arguments> arguments,
                                        mote::nonvolatile store);

} // namespace rubicon
