#include "bridge/ros2/message_template.hpp"

#include <charconv>
#include <utility>

#include <nlohmann/json.hpp>

#include "bridge/table/payload.hpp"

namespace rubicon::bridge {

namespace {

/// The name of the blank that this is, if it is one.
std::optional<std::string_view> blank_of(const nlohmann::json& x) {
  if (!x.is_string())
    return std::nullopt;
  const std::string_view text = x.get_ref<const std::string&>();
  return text.starts_with('$') ? std::optional(text.substr(1)) : std::nullopt;
}

/// Not deeper than json_depth_max.
void add_blanks(const nlohmann::json& x, std::vector<std::string>& to) {
  if (const auto name = blank_of(x))
    to.emplace_back(*name);
  else if (x.is_structured())
    for (const auto& each : x)
      add_blanks(each, to);
}

bool fill(nlohmann::json& x, const message_template::lookup& values) {
  if (const auto name = blank_of(x)) {
    auto value = values(*name);
    if (!value)
      return false;
    x = *std::move(value);
    return true;
  }
  if (x.is_structured())
    for (auto& each : x)
      if (!fill(each, values))
        return false;
  return true;
}

} // namespace

message_template::message_template(std::string_view document) {
  if (document.size() > octets_max)
    return;
  auto parsed = bounded_json(document);
  if (parsed.is_object())
    content_ = std::make_shared<const nlohmann::json>(std::move(parsed));
}

std::vector<std::string> message_template::blanks() const {
  std::vector<std::string> out;
  if (content_ != nullptr)
    add_blanks(*content_, out);
  return out;
}

std::optional<nlohmann::json> message_template::filled(const lookup& values) const {
  std::optional<nlohmann::json> out(*content_);
  if (!fill(*out, values))
    out.reset();
  return out;
}

const nlohmann::json* member_at(const nlohmann::json& x, std::string_view path) {
  const auto* at = &x;
  while (!path.empty()) {
    const auto dot = path.find('.');
    const auto part = path.substr(0, dot);
    if (at->is_object()) {
      const auto found = at->find(part);
      if (found == at->end())
        return nullptr;
      at = &*found;
    } else if (at->is_array()) {
      std::size_t index = 0;
      const auto [stop, error] = std::from_chars(part.data(), part.data() + part.size(), index);
      if (error != std::errc{} || stop != part.data() + part.size() || index >= at->size())
        return nullptr;
      at = &(*at)[index];
    } else
      return nullptr;
    path = dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
  }
  return at;
}

} // namespace rubicon::bridge
