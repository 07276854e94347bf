// One PEIS kernel, its links to other kernels, and the components that use it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "actors/base/line_allowance.hpp"
#include "actors/base/timer.hpp"
#include "actors/messages/links.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/peis/real_links.hpp"
#include "config/plan/ecology.hpp"
#include "core/numbers/random.hpp"
#include "peis/kernel/kernel.hpp"
#include "peis/kernel_clients.hpp"
#include "peis/media/simulated_link.hpp"
#include "report/report.hpp"

namespace rubicon {

/// What a peer actor is made of.
struct peis_peer_arguments {
  peis::kernel_config config;
  std::string name;
  std::uint64_t seed = 0;    ///< of the ecology
  std::uint64_t station = 0; ///< in the simulated network: one of a kind, never used before
  std::uint32_t incarnation = 0;
  bool is_first = true; ///< of the peer's lives in this process
  config::peis_description network;
  bool discovery = true; ///< takes part in the announcements of the simulated network
  std::optional<real_links_config> real; ///< links of the real network, in wall time only
  peis_lan_actor lan;                    ///< nullptr: there is no simulated network
  peis_bluetooth_actor bluetooth;        ///< nullptr: no adapters
  join_bluetooth adapters;               ///< without `user`
  ecology_actor ecology;
};

struct peis_peer_state {
  /// Our end of a simulated link.
  struct link_end {
    link_end_actor other;
    peis::simulated_link line;
  };

  peis_peer_arguments arguments;
  peis::kernel kernel;
  random_stream rng;
  std::map<peis::link_id, link_end> links;
  std::set<peis::link_id> tcp_links; ///< open ones
  std::unique_ptr<real_links> real;  ///< nullptr: none
  peis::kernel_clients clients;
  std::map<peis::client_id, caf::strong_actor_ptr> components; ///< by CAF's ids, and monitored
  bool paused = false;
  bool left = false;
  init_actor init;                         ///< which is asked before this ends; nullptr: none is
  std::vector<std::function<void()>> held; ///< what has come during a pause
  std::uint64_t held_lost = 0;
  std::uint64_t packages_lost = 0; ///< on the simulated network, sent by us
  report::cause_counts links_closed;
  line_allowance closings; ///< that are logged
  line_allowance claims;   ///< to our id, the same
  line_allowance debugs;   ///< passed on: each writer of our tuples can ask
  timer wake;
};

using peer_pointer = scheduler::actor_pointer<peis_peer_state, peis_peer_actor>;

// actors/peis/peis_outputs.cpp

/// Carries out what the kernel returned, then notifies components and sets the timer.
void perform_outputs(peer_pointer self, peis::outputs todo);

/// Sends components what is for them.
void notify_components(peer_pointer self, peis::kernel_clients::outputs todo);

/// Broadcasts the exit and closes all links.
void leave_and_close(peer_pointer self);

/// Ends the process of this peer.
void quit_process(peer_pointer self);

/// Asks the init of its host, whose components end before this does.
/// @returns whether there is one
bool ask_init(peer_pointer self);

// actors/peis/peis_report.cpp
void send_status(peer_pointer self);

/// In its present life, by cause.
[[nodiscard]] report::cause_counts packages_lost(const peis_peer_state& x);

// actors/peis/lan_link.cpp

/// Asks the medium of the address for a link.
void ask_for_link(peer_pointer self, const peis::connect_to& x);

/// Sends octets over a simulated link, as its condition allows.
void transmit(peer_pointer self, peis::link_id id, payload octets);

/// Notifies the far end of a simulated link that it is closed, after all that was sent.
void notify_closed(peer_pointer self, peis::link_id id, const peis_peer_state::link_end& link);

/// Messages that wait while a kernel stands still; more are lost.
inline constexpr std::size_t held_max = 65536;

peis_peer_actor::behavior_type peis_peer(peer_pointer self, peis_peer_arguments arguments);

} // namespace rubicon
