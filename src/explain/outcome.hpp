// How it ended with a message or a value, in numbers and in one sentence.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "explain/traces.hpp"

namespace rubicon::explain {

enum class message_status : std::uint8_t {
  delivered,
  lost,      ///< not there, and nobody carries it any more
  refused,   ///< by the sender's own mote, at once
  in_flight, ///< at the end of the record
};

[[nodiscard]] std::string_view to_string(message_status x);

/// Tries beyond the first of each hop or message.
struct retries {
  std::uint32_t radio = 0;     ///< frames
  std::uint32_t serial = 0;    ///< writes to a line
  std::uint32_t peis = 0;      ///< packages
  std::uint32_t transport = 0; ///< of the message, end to end
};

struct outcome {
  message_status status = message_status::in_flight;
  std::optional<duration> took; ///< until it was delivered
  explain::retries retries;
  std::string where;    ///< it was lost: `kitchen/mote-5 → kitchen/sink`; empty: nowhere special
  std::string why;      ///< empty unless it was lost or refused
  std::string cause;    ///< of its loss, as docs/losses.md lists them; empty: not accounted for
  std::string obstacle; ///< `why` without how often it was tried: what ended it
};

[[nodiscard]] outcome outcome_of(const traces& all, const message& x);

/// Why a hop did not arrive, such as `4 tries: collision, 3 × out of reach`; empty if it did.
[[nodiscard]] std::string obstacle(const node& x);

/// `collision, 3 × loss`: outcomes of those attempts that did not arrive, in order.
[[nodiscard]] std::string failures(const node& x);

/// Attempts beyond the first of each fragment.
[[nodiscard]] std::uint32_t repeats(const node& x);

/// Between whom: `kitchen/climate-7 → kitchen/sink`.
[[nodiscard]] std::string route_of(const node& x);

/// Who has subscribed to this value, and when they received it. Not those that subscribed later,
/// nor those that never receive anything again: they have ended.
struct audience {
  std::string who;
  std::optional<duration> after; ///< nothing: not received
};
[[nodiscard]] std::vector<audience> audience_of(const traces& all, const tuple_value& x);

} // namespace rubicon::explain
