// Requests of a program that steers a run (docs/steering.md): JSON, a line each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/tuples/key.hpp"

namespace rubicon::steering {

inline constexpr std::size_t line_octets_max = std::size_t{1} << 20; ///< without its end
inline constexpr std::size_t batch_max = 4096;                       ///< requests in a line
inline constexpr std::size_t words_octets_max = 4096;                ///< of a key, value or name

/// Time goes on. One of the two is set.
struct step_request {
  std::optional<duration> length = {};
  std::optional<instant> until = {};
};
struct get_request {
  std::string peer;
  std::string owner; ///< empty: `peer`
  std::string key;
};
struct set_request {
  std::string peer;
  std::string key;
  std::string value;
};
/// Answers to steps report writes of these tuples from now on.
struct tuples_request {
  std::string owner; ///< empty: of all
  peis::key pattern;
};
/// Answers to steps report events from now on.
struct events_request {};
/// A fault or a change, as `rubicon fault` takes it.
struct fault_request {
  std::string words;
};
/// A program of the mote sends a message (D1.1 5.3.3).
struct send_request {
  std::string mote;
  std::string to; ///< a mote, or a peer of the ecology
  bytes octets;
  std::uint8_t am_type = 10;
  bool reliable = true;
};
struct motes_request {};
struct report_request {};
struct record_request {};
/// What was done, as tables of a file.
struct tables_request {};
struct finish_request {};

using request = std::variant<step_request, get_request, set_request, tuples_request, events_request,
                             fault_request, send_request, motes_request, report_request,
                             record_request, tables_request, finish_request>;

/// A request, or why it is none.
using request_or_reason = std::variant<request, std::string>;

struct request_line {
  bool is_batch = false; ///< an array: the answer is one too
  std::vector<request_or_reason> requests;
};

/// What a line requests, or why none of it can be read, with the place.
[[nodiscard]] std::variant<request_line, std::string> read_line(std::string_view line);

} // namespace rubicon::steering
