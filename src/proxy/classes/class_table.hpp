// The latent proxy classes, and which of them a signature belongs to (PXY-09, PXY-11, PXY-13).
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "proxy/classes/proxy_class.hpp"
#include "proxy/classes/signature.hpp"

namespace rubicon::proxy {

class class_table {
public:
  class_table() = default;
  explicit class_table(std::vector<proxy_class> classes) : classes_(std::move(classes)) {}

  /// The class with the narrowest type range around the signature's type; of equally narrow ones
  /// the first in the table. A range whose `first` is above its `last` holds nothing.
  /// On channels other than `wsn` the class with the longest prefix of the id.
  /// @returns nullptr if no class claims it; else valid as long as the table
  [[nodiscard]] const proxy_class* find(const signature& percept) const;

  /// By name; nullptr if there is none.
  [[nodiscard]] const proxy_class* find(std::string_view name) const;

  [[nodiscard]] std::size_t size() const { return classes_.size(); }

private:
  [[nodiscard]] const proxy_class* find_by_id(const signature& percept) const;

  std::vector<proxy_class> classes_;
};

/// Those that managers know by now.
[[nodiscard]] class_table known_at(const std::vector<proxy_class>& all, instant now);

/// When the next of them becomes known; nothing: all are.
[[nodiscard]] std::optional<instant> next_known(const std::vector<proxy_class>& all, instant now);

} // namespace rubicon::proxy
