// The callbacks of a program that drives a peer by itself.
#pragma once

#include <functional>
#include <variant>

#include "peis/kernel/kernel_events.hpp"
#include "peis/tuples/tuple.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peer {

using tuple_callback = std::function<void(const peis::tuple_pointer&)>;
using outcome_callback = std::function<void(const peis::outcome&)>;
using message_callback = std::function<void(const peis::message&)>;
/// A host can be reached and described, or cannot any more.
using host_callback = std::function<void(peer_id host, bool is_there)>;

/// The handle, or why there is none.
using watch_result = std::variant<peis::subscription_id, peis::cause>;

} // namespace rubicon::peer
