#include "cli/options/option_values.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>

#include "config/toml/units.hpp"
#include "core/text/ipv4_network.hpp"

namespace rubicon::cli {

namespace {

/// `1:30`, `0:01:30` or `1:30.250`, as reports write times.
std::optional<duration> parse_clock(std::string_view text) {
  constexpr std::uint64_t hours_max = 24 * 3650; // as long as a run may be
  const auto point = text.find('.');
  const auto last = text.substr(0, point).rfind(':');
  if (last == std::string_view::npos || text.size() > 24)
    return std::nullopt;
  const auto seconds = config::parse_duration(std::string(text.substr(last + 1)) + 's');
  const auto first = text.find(':');
  const auto above = parse_whole(text.substr(0, first)); // minutes, or hours
  const auto minutes =
      first == last ? above : parse_whole(text.substr(first + 1, last - first - 1));
  const bool has_hours = first != last;
  if (!seconds || *seconds >= 60s || !above || !minutes || *above > hours_max * 60 ||
      (has_hours && (*minutes >= 60 || *above > hours_max)))
    return std::nullopt;
  const auto whole = has_hours ? *above * 60 + *minutes : *minutes;
  return *seconds + std::chrono::minutes(static_cast<std::int64_t>(whole));
}

} // namespace

std::optional<std::uint64_t> parse_whole(std::string_view text) {
  std::uint64_t x = 0;
  const auto* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, x);
  return error == std::errc{} && stop == end ? std::optional(x) : std::nullopt;
}

duration parse_length(const std::string& text, const char* option) {
  const auto length = config::parse_duration(text);
  if (!length || *length <= 0s)
    throw CLI::ValidationError(option, "not a length of time: '" + text + "' (say 90s or 10min)");
  return *length;
}

duration parse_moment(const std::string& text, const char* option) {
  if (const auto moment = parse_clock(text))
    return *moment;
  if (const auto length = config::parse_duration(text); length && *length > 0s)
    return *length;
  throw CLI::ValidationError(option, "not a time of the run: '" + text +
                                         "' (say 90s, 10min or, as reports have it, 1:30)");
}

double parse_speed(const std::string& text) {
  double speed = 0;
  if (!CLI::detail::lexical_cast(text, speed) || !std::isfinite(speed) || speed <= 0)
    throw CLI::ValidationError("--speed", "not a positive number: '" + text + "'");
  return speed;
}

reseeding::settings parse_reseeding(const std::string& text) {
  const auto colon = text.rfind(':');
  const auto since = config::parse_duration(text.substr(0, colon));
  const auto key = colon == std::string::npos
                       ? std::nullopt
                       : parse_whole(std::string_view(text).substr(colon + 1));
  if (!since || *since < 0s || !key)
    throw CLI::ValidationError("--reseed", "not a time and a number: '" + text + "' (say 90s:1)");
  return {instant(*since), *key};
}

std::uint64_t parse_seed(const std::string& text) {
  if (const auto seed = parse_whole(text))
    return *seed;
  throw CLI::ValidationError("--seed", "not a number from 0 to 2^64 - 1: '" + text + "'");
}

seed_range parse_seeds(const std::string& text) {
  const auto dots = text.find("..");
  const auto first = parse_whole(std::string_view(text).substr(0, dots));
  const auto last =
      dots == std::string::npos ? first : parse_whole(std::string_view(text).substr(dots + 2));
  if (!first || !last || *last < *first)
    throw CLI::ValidationError("--seeds", "not a range of seeds: '" + text + "' (say 1..100)");
  return {*first, *last};
}

std::uint64_t parse_jobs(const std::string& text) {
  const auto jobs = parse_whole(text);
  if (!jobs || *jobs < 1 || *jobs > 1024)
    throw CLI::ValidationError("--jobs", "not a number from 1 to 1024: '" + text + "'");
  return *jobs;
}

void parse_page_place(const std::string& text, page_place& x, const char* option) {
  const auto colon = text.rfind(':');
  const auto port = parse_whole(colon == std::string::npos ? text : text.substr(colon + 1));
  if (colon != std::string::npos)
    x.address = text.substr(0, colon);
  if (!parse_ipv4_address(x.address) || !port || *port > 65535)
    throw CLI::ValidationError(option, "not a port, or an IPv4 address and a port: '" + text +
                                           "' (say 8080, or nothing for any)");
  x.port = static_cast<std::uint16_t>(*port);
}

void parse_page_host(const std::string& text, page_place& x) {
  constexpr std::size_t name_max = 253; // RFC 1035 2.3.4
  constexpr std::size_t hosts_max = 16;
  std::string name = text;
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool is_name =
      !name.empty() && name.size() <= name_max &&
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-.") == std::string::npos;
  if (!is_name)
    throw CLI::ValidationError("--view-host", "not the name of a host, without port: '" + text +
                                                  "' (say house.example)");
  if (x.hosts.size() >= hosts_max)
    throw CLI::ValidationError("--view-host", "at most 16 names");
  x.hosts.push_back(std::move(name));
}

} // namespace rubicon::cli
