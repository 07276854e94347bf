// A JSON document with blanks that are filled for each message.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace rubicon::bridge {

/// Each text of the document that begins with `$` is a blank: `{"data": "$number"}`.
class message_template {
public:
  /// What a blank stands for, by its name without `$`; nothing: there is no such value now.
  using lookup = std::function<std::optional<nlohmann::json>(std::string_view name)>;

  /// Longest document, in octets.
  static constexpr std::size_t octets_max = 4096;

  /// @param document {} if it is not JSON, or no object
  explicit message_template(std::string_view document = "{}");

  [[nodiscard]] bool is_valid() const { return content_ != nullptr; }
  /// The names of all blanks.
  [[nodiscard]] std::vector<std::string> blanks() const;
  /// @returns nothing if a blank has no value. @pre is_valid()
  [[nodiscard]] std::optional<nlohmann::json> filled(const lookup& values) const;

private:
  std::shared_ptr<const nlohmann::json> content_; ///< nullptr: not valid
};

/// The part of a document at a path: `pose.position.x`, `ranges.0`; nullptr: there is none.
[[nodiscard]] const nlohmann::json* member_at(const nlohmann::json& x, std::string_view path);

} // namespace rubicon::bridge
