#include "config/toml/values.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "config/toml/units.hpp"
#include "core/tuples/tuple_key.hpp"
#include "peis/wire/link_url.hpp"

namespace rubicon::config {

namespace {

bool is_tuple_key(std::string_view x, bool wildcards) {
  if (x.empty() || !fits_tuple_key(x))
    return false;
  for (std::size_t from = 0; from <= x.size();) {
    const auto end = std::min(x.find('.', from), x.size());
    const auto part = x.substr(from, end - from);
    const bool wild = wildcards && part == "*";
    if (part.empty() || (!wild && !std::all_of(part.begin(), part.end(), is_name_character)))
      return false;
    from = end + 1;
  }
  return true;
}

/// The number in a node that has one.
std::optional<double> number_in(const node& x) {
  if (const auto* integer = x.as<std::int64_t>())
    return static_cast<double>(*integer);
  if (const auto* decimal = x.as<double>(); decimal != nullptr && std::isfinite(*decimal))
    return *decimal;
  return std::nullopt;
}

/// What `parse` makes of the text in a node that has one.
template <class T>
std::optional<T> parsed(const node& x, std::optional<T> (*parse)(std::string_view)) {
  const auto* found = x.as<std::string>();
  return found == nullptr ? std::nullopt : parse(*found);
}

/// The unsigned number that is the whole of `x`.
std::optional<std::uint32_t> unsigned_in(std::string_view x) {
  std::uint32_t out = 0;
  const auto [stop, error] = std::from_chars(x.data(), x.data() + x.size(), out);
  if (error != std::errc{} || stop != x.data() + x.size())
    return std::nullopt;
  return out;
}

/// The same, or in hexadecimal: 0xff00.
std::optional<std::uint32_t> bits_in(std::string_view x) {
  if (!x.starts_with("0x"))
    return unsigned_in(x);
  std::uint32_t out = 0;
  const auto [stop, error] = std::from_chars(x.data() + 2, x.data() + x.size(), out, 16);
  if (error != std::errc{} || stop != x.data() + x.size())
    return std::nullopt;
  return out;
}

/// "100..119"; what is none holds the type 0.
proxy::type_range range_in(std::string_view x) {
  const auto middle = std::min(x.find(".."), x.size());
  const auto first = unsigned_in(x.substr(0, middle));
  const auto last = unsigned_in(x.substr(std::min(middle + 2, x.size())));
  if (first && last && *first <= *last)
    return {*first, *last};
  return {};
}

/// "0x0100/0xff00"; the same.
proxy::type_range masked_in(std::string_view x) {
  const auto slash = x.find('/');
  const auto value = bits_in(x.substr(0, slash));
  const auto mask = bits_in(x.substr(slash + 1));
  if (value && mask && (*value & ~*mask) == 0)
    return {*value, *value, *mask};
  return {};
}

/// Pairs of a time and what `kind` reads, the times strictly increasing.
template <class Kind>
std::optional<std::vector<std::pair<duration, typename Kind::type>>>
points(const node& x, const asker& who, const Kind& kind, const std::string& wanted) {
  const auto* elements = x.as<node_array>();
  if (elements == nullptr || elements->empty())
    return who.refuse(x, wanted);
  std::vector<std::pair<duration, typename Kind::type>> out;
  for (const auto& each : *elements) {
    const auto* pair = each.as<node_array>();
    if (pair == nullptr || pair->size() != 2)
      return who.refuse(each, wanted);
    const auto at = read(time_span{}, pair->front(), who);
    const auto value = read(kind, pair->back(), who);
    if (!at || !value)
      return std::nullopt;
    if (!out.empty() && *at <= out.back().first) {
      who.complain(pair->front(), "the times of `" + std::string(who.key) +
                                      "` must increase from one to the next");
      return std::nullopt;
    }
    out.emplace_back(*at, *value);
  }
  return out;
}

} // namespace

std::nullopt_t asker::refuse(const node& x, const std::string& wanted) const {
  return refuse(x, wanted, {});
}

std::nullopt_t asker::refuse(const node& x, const std::string& wanted,
                             const std::string& end) const {
  in.problems.add(x.at,
                  '`' + std::string(key) + "` must be " + wanted + ", not " + describe(x) + end);
  return std::nullopt;
}

std::string table_of(const std::string& key, const node& x) {
  const bool is_value =
      x.as<std::string>() != nullptr || x.as<bool>() != nullptr || number_in(x).has_value();
  return "{ " + key + " = " + (is_value ? describe(x) : "\"value\"") + " }";
}

std::optional<duration> time_of_run::read(const node& x, const asker& who) {
  const auto found = config::read(time_span{}, x, who);
  if (found && *found > who.in.end)
    who.complain(x, '`' + std::string(who.key) + "` is after the end of the run, which is at " +
                        to_text(who.in.end));
  return found;
}

std::optional<duration> calendar_day::read(const node& x, const asker& who) {
  namespace chrono = std::chrono;
  constexpr std::size_t size = 10;
  const auto* found = x.as<std::string>();
  if (found != nullptr && found->size() == size && (*found)[4] == '-' && (*found)[7] == '-') {
    const std::string_view text = *found;
    const auto year = unsigned_in(text.substr(0, 4));
    const auto month = unsigned_in(text.substr(5, 2));
    const auto day = unsigned_in(text.substr(8, 2));
    if (year && month && day && *year >= 1970 && *year < 2150) {
      const chrono::year_month_day date(chrono::year(static_cast<int>(*year)),
                                        chrono::month(*month), chrono::day(*day));
      if (date.ok())
        return chrono::sys_days(date).time_since_epoch();
    }
  }
  return who.refuse(x, "a date from 1970 to 2149 in quotation marks, as in \"2026-11-05\"");
}

std::optional<duration> time_of_day::read(const node& x, const asker& who) {
  constexpr std::size_t hours_and_minutes = 5;
  constexpr std::size_t with_seconds = 8;
  const auto* found = x.as<std::string>();
  const auto number = [&](std::size_t from, std::uint32_t end) -> std::optional<std::uint32_t> {
    const auto out = unsigned_in(std::string_view(*found).substr(from, 2));
    return out && *out < end ? out : std::nullopt;
  };
  if (found != nullptr &&
      (found->size() == hours_and_minutes ||
       (found->size() == with_seconds && (*found)[hours_and_minutes] == ':')) &&
      (*found)[2] == ':') {
    const auto hours = number(0, 24);
    const auto minutes = number(3, 60);
    const auto seconds = found->size() == with_seconds ? number(6, 60) : std::optional(0U);
    if (hours && minutes && seconds)
      return *hours * 1h + *minutes * 1min + *seconds * 1s;
  }
  return who.refuse(x, "a time of day in quotation marks, as in \"07:30\" or \"07:30:15\"");
}

std::optional<double> read(const real& kind, const node& x, const asker& who) {
  const auto found = number_in(x);
  if (found && *found >= kind.min && *found <= kind.max)
    return found;
  if (kind.min <= -std::numeric_limits<double>::max())
    return who.refuse(x, "a number");
  if (kind.max >= std::numeric_limits<double>::max())
    return who.refuse(x, "a number from " + shown(kind.min));
  return who.refuse(x, "a number from " + shown(kind.min) + " to " + shown(kind.max));
}

std::optional<bool> read(const flag& /*kind*/, const node& x, const asker& who) {
  if (const auto* found = x.as<bool>())
    return *found;
  return who.refuse(x, "true or false");
}

std::optional<std::string> read(const text& kind, const node& x, const asker& who) {
  const auto* found = x.as<std::string>();
  const auto control = [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; };
  if (found == nullptr || found->empty() || found->size() > kind.octets_max ||
      std::any_of(found->begin(), found->end(), control))
    return who.refuse(x, "a text of 1 to " + std::to_string(kind.octets_max) +
                             " octets without control characters");
  return *found;
}

std::optional<std::string> read(const name_text& /*kind*/, const node& x, const asker& who) {
  const auto* found = x.as<std::string>();
  if (found == nullptr || !is_name(*found))
    return who.refuse(x, "a name of 1 to 32 letters, digits, - and _");
  return *found;
}

std::optional<std::string> read(const tuple_key& kind, const node& x, const asker& who) {
  const auto* found = x.as<std::string>();
  if (found == nullptr || !is_tuple_key(*found, kind.wildcards))
    return who.refuse(x, std::string("a tuple key of 1 to 7 parts between dots, each of letters, "
                                     "digits, - and _") +
                             (kind.wildcards ? " or a single *" : ""));
  return *found;
}

std::optional<duration> read(const time_span& kind, const node& x, const asker& who) {
  const auto found = parsed(x, parse_duration);
  if (found && *found >= kind.min && *found <= kind.max)
    return found;
  if (found)
    return who.refuse(x, "a time from " + to_text(kind.min) + " to " + to_text(kind.max));
  return who.refuse(x, "a time with its unit (ns, us, ms, s, min, h or d), as in \"31s\" or "
                       "\"1min30s\"");
}

std::optional<duration> read(const time_step& /*kind*/, const node& x, const asker& who) {
  constexpr duration longest = 24h * 3650;
  const auto* found = x.as<std::string>();
  const bool back = found != nullptr && found->starts_with('-');
  const auto size =
      found == nullptr ? std::nullopt : parse_duration(std::string_view(*found).substr(back));
  if (!size || *size == 0s || *size > longest)
    return who.refuse(x, "a time with its unit, forward or back, as in \"5s\" or \"-5s\"");
  return back ? -*size : *size;
}

std::optional<double> read(const ratio& /*kind*/, const node& x, const asker& who) {
  auto found = parsed(x, parse_ratio);
  if (!found)
    found = number_in(x);
  if (!found || *found < 0 || *found > 1)
    return who.refuse(x, "a ratio from 0 to 1, or from \"0%\" to \"100%\"");
  return found;
}

std::optional<double> read(const metres& kind, const node& x, const asker& who) {
  const auto found = parsed(x, parse_length_m);
  if (found && *found >= kind.min && *found <= kind.max)
    return found;
  return who.refuse(x, "a length from " + shown(kind.min) + " m to " + shown(kind.max) +
                           " m with its unit (cm, m or km), as in \"25m\"");
}

std::optional<double> read(const charge& /*kind*/, const node& x, const asker& who) {
  constexpr double min_mah = 0.001;
  constexpr double max_mah = 1e6;
  const auto found = parsed(x, parse_charge_mah);
  if (found && *found >= min_mah && *found <= max_mah)
    return found;
  return who.refuse(x,
                    "a charge from 0.001 mAh to 1000 Ah with its unit (mAh or Ah), or its energy "
                    "at 3 V (J or kJ), as in \"2000mAh\" or \"21.6kJ\"");
}

std::optional<double> read(const power_level& kind, const node& x, const asker& who) {
  const auto found = parsed(x, parse_dbm);
  if (found && *found >= kind.min_dbm && *found <= kind.max_dbm)
    return found;
  return who.refuse(x, "a power from " + shown(kind.min_dbm) + " to " + shown(kind.max_dbm) +
                           " dBm with its unit, as in \"-98dBm\"");
}

std::optional<double> read(const decibels& kind, const node& x, const asker& who) {
  const auto found = parsed(x, parse_db);
  if (found && *found >= kind.min && *found <= kind.max)
    return found;
  return who.refuse(x, "a ratio from " + shown(kind.min) + " to " + shown(kind.max) +
                           " dB with its unit, as in \"3.5dB\"");
}

std::optional<double> read(const frequency& /*kind*/, const node& x, const asker& who) {
  constexpr double min_mhz = 100;
  constexpr double max_mhz = 100'000;
  const auto found = parsed(x, parse_frequency_mhz);
  if (found && *found >= min_mhz && *found <= max_mhz)
    return found;
  return who.refuse(x, "a frequency from 100 MHz to 100 GHz with its unit (MHz or GHz), as in "
                       "\"2480MHz\"");
}

std::optional<std::uint32_t> read(const baud& /*kind*/, const node& x, const asker& who) {
  constexpr std::int64_t min = 300;
  constexpr std::int64_t max = 4'000'000;
  auto found = parsed(x, parse_baud);
  if (const auto* plain = x.as<std::int64_t>())
    found = *plain;
  if (!found || *found < min || *found > max)
    return who.refuse(
        x, "a rate from 300 to 4000000 baud, as in 57600 or \"57600baud\", or the name of a "
           "platform that has it, as \"telosb\"");
  return static_cast<std::uint32_t>(*found);
}

std::optional<std::uint64_t> read(const bit_rate& /*kind*/, const node& x, const asker& who) {
  constexpr double min_bps = 1000;
  constexpr double max_bps = 1e12;
  auto found = parsed(x, parse_bit_rate_bps);
  if (const auto* plain = x.as<std::int64_t>())
    found = static_cast<double>(*plain);
  if (!found || (*found != 0 && (*found < min_bps || *found > max_bps)))
    return who.refuse(x, "a rate from 1 kbit/s to 1000 Gbit/s with its unit (bit/s, kbit/s, Mbit/s "
                         "or Gbit/s), as in \"10Mbit/s\", or 0 for no limit");
  return static_cast<std::uint64_t>(*found);
}

std::optional<std::string> peer_url::read(const node& x, const asker& who) {
  const auto* found = x.as<std::string>();
  const auto url =
      found == nullptr ? result<peis::link_url>(errc::bad_value) : peis::parse_link_url(*found);
  using scheme = peis::link_url::scheme;
  if (!url || url->medium == scheme::inproc)
    return who.refuse(x, "the address of a peer, as in \"tcp://192.168.1.7:8000\"");
  return to_string(*url);
}

std::optional<std::string> interface_address::read(const node& x, const asker& who) {
  const auto* found = x.as<std::string>();
  if (found == nullptr || !parse_ipv4_address(*found))
    return who.refuse(x, "an IPv4 address, as in \"192.168.1.7\"; \"0.0.0.0\" for all");
  return *found;
}

std::optional<ipv4_network> network_text::read(const node& x, const asker& who) {
  const auto* found = x.as<std::string>();
  const auto parsed =
      found == nullptr ? result<ipv4_network>(errc::bad_value) : parse_ipv4_network(*found);
  if (!parsed)
    return who.refuse(x, "a network such as \"192.168.1.0/24\", or one address");
  return *parsed;
}

std::optional<position> read(const place& /*kind*/, const node& x, const asker& who) {
  constexpr double farthest_m = 1e6;
  const auto* elements = x.as<node_array>();
  const auto refuse = [&](const node& what) {
    return who.refuse(what, "[x, y] or [x, y, z] in metres, each at most 1000000");
  };
  if (elements == nullptr || elements->size() < 2 || elements->size() > 3)
    return refuse(x);
  std::vector<double> numbers;
  for (const auto& each : *elements) {
    const auto number = number_in(each);
    if (!number || std::abs(*number) > farthest_m)
      return refuse(each);
    numbers.push_back(*number);
  }
  return position{numbers[0], numbers[1], numbers.size() == 3 ? numbers[2] : 0};
}

std::optional<way::type> way::read(const node& x, const asker& who) {
  return points(x, who, place{},
                "points of a time and a position, as in "
                "[[\"0s\", [0, 2]], [\"1min\", [30, 2]]]");
}

std::optional<time_points::type> read(const time_points& /*kind*/, const node& x,
                                      const asker& who) {
  return points(x, who, real{},
                "points of a time and a number, as in [[\"0s\", 21.0], [\"5min\", 27]]");
}

std::optional<proxy::type_range> type_span::read(const node& x, const asker& who) {
  proxy::type_range out;
  if (const auto* single = x.as<std::int64_t>();
      single != nullptr && std::in_range<std::uint32_t>(*single)) {
    out.first = out.last = static_cast<std::uint32_t>(*single);
  } else if (const auto* span = x.as<std::string>()) {
    out = span->find('/') == std::string::npos ? range_in(*span) : masked_in(*span);
  }
  if (out.first == 0)
    return who.refuse(x, "types from 1 to 4294967295, as in 101, \"100..119\" or "
                         "\"0x0100/0xff00\" (a value and the mask under which types have it)");
  return out;
}

word<const radio::platform*> platform_name() {
  word<const radio::platform*> out;
  for (const auto& each : radio::platforms())
    out.choices.emplace_back(each.name, &each);
  return out;
}

word<std::string> mac_name() {
  word<std::string> out;
  for (const auto& each : radio::mac_names())
    out.choices.emplace_back(each, each);
  return out;
}

std::optional<bytes> read(const hex_octets& /*kind*/, const node& x, const asker& who) {
  const auto* found = x.as<std::string>();
  auto octets = found == nullptr ? std::nullopt : from_hex(*found);
  if (!octets || octets->empty() || octets->size() > payload_octets_max)
    return who.refuse(x, "1 to 100 octets in hexadecimal, as in \"01\" or \"00ff\"");
  return octets;
}

std::string alternatives(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0)
      text += i + 1 == words.size() ? " or " : ", ";
    text += '"' + words[i] + '"';
  }
  return text;
}

} // namespace rubicon::config
