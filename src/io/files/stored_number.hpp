// A number that outlives the process, and the computer's power.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

namespace rubicon::io {

/// A file with a number, in decimal. The file holds the new number or the old one: a write that
/// is cut off leaves no half of it.
class stored_number {
public:
  /// @returns the number; 0 if there is no such file; or why it is not known
  [[nodiscard]] static std::variant<stored_number, std::string> open(const std::string& path);

  [[nodiscard]] std::uint32_t value() const { return value_; }

  /// @returns empty, or why it is not stored
  [[nodiscard]] std::string store(std::uint32_t x);

private:
  explicit stored_number(std::string path) : path_(std::move(path)) {}

  std::string path_;
  std::uint32_t value_ = 0;
};

/// The path of such a file of this user, in a folder that is made: in XDG_STATE_HOME/rubicon, or
/// else in ~/.local/state/rubicon. @returns empty if there is no such folder
[[nodiscard]] std::string state_file(const std::string& name);

} // namespace rubicon::io
