// Values of options: each is parsed, or refused with a ValidationError.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "cli/swarm.hpp"
#include "cli/words/watch_options.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"

namespace rubicon::cli {

/// A decimal number without sign; nothing else.
[[nodiscard]] std::optional<std::uint64_t> parse_whole(std::string_view text);

/// `90s`, `10min`; more than zero.
[[nodiscard]] duration parse_length(const std::string& text, const char* option = "--for");

/// A moment of a run: `90s`, `10min`, or as reports write it, `1:30`, `1:02:03.500`.
[[nodiscard]] duration parse_moment(const std::string& text, const char* option);

/// More than zero.
[[nodiscard]] double parse_speed(const std::string& text);
[[nodiscard]] reseeding::settings parse_reseeding(const std::string& text); ///< `90s:7`

[[nodiscard]] std::uint64_t parse_seed(const std::string& text);

/// `A..B`, or one seed
[[nodiscard]] seed_range parse_seeds(const std::string& text);

/// 1 to 1024
[[nodiscard]] std::uint64_t parse_jobs(const std::string& text);

/// `PORT` or `ADDRESS:PORT`
void parse_page_place(const std::string& text, page_place& x, const char* option = "--view");
/// Adds the name of a host, in lower case.
void parse_page_host(const std::string& text, page_place& x);

} // namespace rubicon::cli
