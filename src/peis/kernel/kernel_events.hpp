// What a kernel returns to its owner, and what it counts.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/bytes.hpp"
#include "peis/overlay/p2p_counters.hpp"
#include "peis/overlay/p2p_events.hpp"
#include "peis/space/tuple_events.hpp"
#include "peis/space/tuple_space_config.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

// to_link, close_link, read_link, pace_link, connect_to and announce: peis/overlay/p2p_events.hpp;
// tuple_changed and tuple_deleted: peis/space/tuple_events.hpp.

/// A whole message for a hooked port.
struct message {
  std::uint16_t port = 0;
  peer_id source;
  bool broadcast = false;
  payload octets;
  provenance from = {};
};

/// How a request ended, once per request. Success of a reliable request means that the destination
/// has acknowledged all of it, of an unreliable one that it is on its way.
struct outcome {
  request_id request;
  bool success = false;
  cause why = cause::none;
};

/// An authorised peer has written our kernel.do-quit (TUP-22): kernel::leave() and end.
struct quit_requested {
  peer_id by;
};

/// Our tuple debug_key was set: by a component of ours, or by another peer (NFR-02). A kernel alone
/// writes no debug log; its owner may.
struct debug_requested {
  std::string text;
};

/// Whose messages a debug log has.
inline constexpr std::string_view debug_key = "rubicon.debug";

using output = std::variant<to_link, close_link, read_link, pace_link, connect_to, announce,
                            tuple_changed, tuple_deleted, message, outcome, host_appeared,
                            host_vanished, quit_requested, traced, id_taken, namesake_found,
                            intercepted, scan_adapter, say_hello, debug_requested>;
using outputs = std::vector<output>;

/// Everything counted; nothing is dropped without appearing here.
struct kernel_counters {
  p2p_counters network;
  tuple_counters tuples;
  std::uint64_t unhooked = 0; ///< messages for ports without hook or that are not served
};
RUBICON_FIELDS(kernel_counters, network, tuples, unhooked);

} // namespace rubicon::peis
