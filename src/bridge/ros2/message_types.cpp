#include "bridge/ros2/message_types.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/decimal.hpp"

namespace rubicon::bridge {

namespace {

/// How the value of a message is written.
enum class value_form : std::uint8_t { text, flag, number, whole, percent, point };

struct known_type {
  std::string_view name;
  value_form form = value_form::text;
  std::string_view member; ///< where the value is
  bool has_header = false;
  std::int64_t min = 0; ///< of whole numbers
  std::uint64_t max = 0;
};

template <class T>
constexpr known_type whole_type(std::string_view name) {
  return {name,
          value_form::whole,
          "data",
          false,
          static_cast<std::int64_t>(std::numeric_limits<T>::min()),
          static_cast<std::uint64_t>(std::numeric_limits<T>::max())};
}

constexpr std::array known_messages{
    known_type{"std_msgs/msg/Bool", value_form::flag, "data"},
    known_type{"std_msgs/msg/String", value_form::text, "data"},
    known_type{"std_msgs/msg/Float32", value_form::number, "data"},
    known_type{"std_msgs/msg/Float64", value_form::number, "data"},
    whole_type<std::int8_t>("std_msgs/msg/Int8"),
    whole_type<std::int16_t>("std_msgs/msg/Int16"),
    whole_type<std::int32_t>("std_msgs/msg/Int32"),
    whole_type<std::int64_t>("std_msgs/msg/Int64"),
    whole_type<std::uint8_t>("std_msgs/msg/UInt8"),
    whole_type<std::uint16_t>("std_msgs/msg/UInt16"),
    whole_type<std::uint32_t>("std_msgs/msg/UInt32"),
    whole_type<std::uint64_t>("std_msgs/msg/UInt64"),
    known_type{"sensor_msgs/msg/Temperature", value_form::number, "temperature", true},
    known_type{"sensor_msgs/msg/RelativeHumidity", value_form::percent, "relative_humidity", true},
    known_type{"sensor_msgs/msg/Illuminance", value_form::number, "illuminance", true},
    known_type{"sensor_msgs/msg/FluidPressure", value_form::number, "fluid_pressure", true},
    known_type{"sensor_msgs/msg/Range", value_form::number, "range", true},
    known_type{"sensor_msgs/msg/BatteryState", value_form::number, "voltage", true},
    known_type{"geometry_msgs/msg/Point", value_form::point, ""},
    known_type{"geometry_msgs/msg/PointStamped", value_form::point, "point", true},
    known_type{"geometry_msgs/msg/Pose", value_form::point, "position"},
    known_type{"geometry_msgs/msg/PoseStamped", value_form::point, "pose.position", true},
};

const known_type* type_named(std::string_view name) {
  const auto found = std::ranges::find(known_messages, name, &known_type::name);
  return found == known_messages.end() ? nullptr : &*found;
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// A part of a name in ROS.
bool is_word(std::string_view x) {
  return !x.empty() && !is_digit(x.front()) &&
         std::ranges::all_of(x, [](char c) { return is_letter(c) || is_digit(c) || c == '_'; });
}

std::optional<double> number_of(const message_source& x) {
  const auto number = number_in(x.text);
  if (!number || !std::isfinite(*number * x.scale))
    return std::nullopt;
  return *number * x.scale;
}

std::optional<bool> flag_of(std::string_view text) {
  const auto word = text_of(payload_type::flag, text);
  return word ? std::optional(*word == "on") : std::nullopt;
}

template <class T>
std::optional<T> integer_in(std::string_view text) {
  T out{};
  const auto* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, out);
  return error == std::errc{} && stop == end ? std::optional(out) : std::nullopt;
}

/// Exact as far as it is written as an integer and not scaled.
std::optional<nlohmann::json> whole_of(const known_type& type, const message_source& x) {
  constexpr double exact_max = 9007199254740992.0; // 2^53
  if (x.scale == 1) {
    if (const auto negative = integer_in<std::int64_t>(x.text); negative && *negative < 0)
      return *negative >= type.min ? std::optional<nlohmann::json>(*negative) : std::nullopt;
    if (const auto positive = integer_in<std::uint64_t>(x.text))
      return *positive <= type.max ? std::optional<nlohmann::json>(*positive) : std::nullopt;
  }
  const auto number = number_of(x);
  if (!number || std::abs(*number) > exact_max)
    return std::nullopt;
  const auto rounded = static_cast<std::int64_t>(std::round(*number));
  if (rounded < type.min || (rounded > 0 && static_cast<std::uint64_t>(rounded) > type.max))
    return std::nullopt;
  return nlohmann::json(rounded);
}

/// Two or three numbers, between blanks.
std::optional<std::array<double, 3>> point_of(const message_source& x) {
  std::array<double, 3> out{};
  std::size_t count = 0;
  auto rest = x.text;
  while (!rest.empty()) {
    const auto end = rest.find(' ');
    const auto number = number_of({x.key, rest.substr(0, end), x.frame, x.scale, x.stamp});
    if (!number || count == out.size())
      return std::nullopt;
    out[count++] = *number;
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  }
  return count >= 2 ? std::optional(out) : std::nullopt;
}

std::optional<nlohmann::json> value_of(const known_type& type, const message_source& x) {
  switch (type.form) {
  case value_form::text:
    return nlohmann::json(x.text);
  case value_form::flag: {
    const auto flag = flag_of(x.text);
    return flag ? std::optional<nlohmann::json>(*flag) : std::nullopt;
  }
  case value_form::whole:
    return whole_of(type, x);
  case value_form::number: {
    const auto number = number_of(x);
    return number ? std::optional<nlohmann::json>(*number) : std::nullopt;
  }
  case value_form::percent: {
    const auto number = number_of(x);
    return number ? std::optional<nlohmann::json>(*number / 100) : std::nullopt;
  }
  case value_form::point: {
    const auto at = point_of(x);
    if (!at)
      return std::nullopt;
    return nlohmann::json::object({{"x", (*at)[0]}, {"y", (*at)[1]}, {"z", (*at)[2]}});
  }
  }
  return std::nullopt;
}

/// A number of a message as text, multiplied.
std::optional<std::string> scaled(const nlohmann::json& x, double scale) {
  if (!x.is_number())
    return std::nullopt;
  if (scale == 1 && x.is_number_integer())
    return word_in(x);
  auto text = shortest_decimal(x.get<double>() * scale);
  return text.empty() ? std::nullopt : std::optional(std::move(text));
}

std::optional<std::string> text_of_point(const nlohmann::json& x, double scale) {
  std::string out;
  for (const auto* name : {"x", "y", "z"}) {
    const auto found = x.is_object() ? x.find(name) : x.end();
    const auto text = found == x.end() ? std::nullopt : scaled(*found, scale);
    if (!text)
      return std::nullopt;
    out += (out.empty() ? "" : " ") + *text;
  }
  return out;
}

std::optional<std::string> text_of_known(const known_type& type, const nlohmann::json& value,
                                         double scale) {
  switch (type.form) {
  case value_form::text:
    return value.is_string() ? text_of(payload_type::text, value.get_ref<const std::string&>())
                             : std::nullopt;
  case value_form::flag:
    return value.is_boolean() ? word_in(value) : std::nullopt;
  case value_form::number:
  case value_form::whole:
    return scaled(value, scale);
  case value_form::percent:
    return scaled(value, scale * 100);
  case value_form::point:
    return text_of_point(value, scale);
  }
  return std::nullopt;
}

nlohmann::json& place_at(nlohmann::json& x, std::string_view path) {
  auto* at = &x;
  while (!path.empty()) {
    const auto dot = path.find('.');
    at = &(*at)[std::string(path.substr(0, dot))];
    path = dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
  }
  return *at;
}

} // namespace

std::optional<std::string> full_type(std::string_view type, std::string_view part) {
  const auto slash = type.find('/');
  const auto last = type.rfind('/');
  if (slash == std::string_view::npos)
    return std::nullopt;
  const auto package = type.substr(0, slash);
  const auto name = type.substr(last + 1);
  const bool is_short = slash == last;
  if (!is_word(package) || !is_word(name) ||
      (!is_short && type.substr(slash + 1, last - slash - 1) != part))
    return std::nullopt;
  return std::string(package) + '/' + std::string(part) + '/' + std::string(name);
}

bool is_ros_name(std::string_view name, std::size_t blanks) {
  if (name.starts_with('/'))
    name.remove_prefix(1);
  while (true) {
    const auto slash = name.find('/');
    std::string part;
    for (auto rest = name.substr(0, slash); !rest.empty();) {
      if (rest.size() >= 3 && rest[0] == '{' && rest[2] == '}' && rest[1] >= '1' &&
          static_cast<std::size_t>(rest[1] - '0') <= blanks) {
        part += 'x';
        rest.remove_prefix(3);
      } else {
        part += rest.front();
        rest.remove_prefix(1);
      }
    }
    if (!is_word(part))
      return false;
    if (slash == std::string_view::npos)
      return true;
    name.remove_prefix(slash + 1);
  }
}

std::string absolute_name(std::string_view name_space, std::string_view name) {
  if (name.starts_with('/'))
    return std::string(name);
  std::string out = name_space.empty() || name_space.starts_with('/') ? "" : "/";
  out += name_space;
  out += '/';
  return out += name;
}

std::string ros_part(std::string_view part) {
  std::string out(part);
  for (auto& c : out)
    if (!is_letter(c) && !is_digit(c))
      c = '_';
  return out;
}

const std::vector<std::string>& known_types() {
  static const auto all = [] {
    std::vector<std::string> out;
    for (const auto& each : known_messages)
      out.emplace_back(each.name);
    return out;
  }();
  return all;
}

const std::vector<std::string>& message_blanks() {
  static const std::vector<std::string> all{"text", "number", "flag",    "x",   "y",
                                            "z",    "sec",    "nanosec", "key", "frame"};
  return all;
}

std::optional<nlohmann::json> value_of_blank(const message_source& x, std::string_view name) {
  if (name == "text")
    return nlohmann::json(x.text);
  if (name == "key")
    return nlohmann::json(x.key);
  if (name == "frame")
    return nlohmann::json(x.frame);
  if (name == "sec" || name == "nanosec")
    return time_message(x.stamp).at(std::string(name));
  if (name == "number")
    return value_of({.name = {}, .form = value_form::number, .member = {}}, x);
  if (name == "flag")
    return value_of({.name = {}, .form = value_form::flag, .member = {}}, x);
  const auto at = point_of(x);
  if (!at || name.size() != 1 || name[0] < 'x' || name[0] > 'z')
    return std::nullopt;
  return nlohmann::json((*at)[static_cast<std::size_t>(name[0] - 'x')]);
}

nlohmann::json time_message(duration x) {
  const auto whole = std::chrono::floor<std::chrono::seconds>(x);
  return {{"sec", whole.count()}, {"nanosec", (x - whole).count()}};
}

std::optional<nlohmann::json> message_of(std::string_view type, const message_source& x) {
  const auto* of = type_named(type);
  if (of == nullptr)
    return std::nullopt;
  auto value = value_of(*of, x);
  if (!value)
    return std::nullopt;
  nlohmann::json out = nlohmann::json::object();
  place_at(out, of->member) = *std::move(value);
  if (of->has_header)
    out["header"] = {{"stamp", time_message(x.stamp)}, {"frame_id", x.frame}};
  if (of->form == value_form::point && of->member.ends_with("position"))
    place_at(out, of->member == "position" ? "orientation" : "pose.orientation") = {
        {"x", 0.0}, {"y", 0.0}, {"z", 0.0}, {"w", 1.0}};
  if (of->member == "voltage")
    out["present"] = true;
  return out;
}

std::optional<std::string> text_of_message(const topic_subscription& rule,
                                           const nlohmann::json& message) {
  const auto* of = rule.member.empty() ? type_named(rule.type) : nullptr;
  const auto* value = member_at(message, of == nullptr ? rule.member : std::string(of->member));
  if (value == nullptr)
    return std::nullopt;
  if (of != nullptr)
    return text_of_known(*of, *value, rule.scale);
  if (rule.value == payload_type::number)
    return scaled(*value, rule.scale);
  const auto word = word_in(*value);
  return word ? text_of(rule.value, *word) : std::nullopt;
}

} // namespace rubicon::bridge
