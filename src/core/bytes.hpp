// Octets: owned, viewed, and shared without copying.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rubicon {

using bytes = std::vector<std::uint8_t>;
using byte_view = std::span<const std::uint8_t>;

[[nodiscard]] inline bytes to_bytes(byte_view x) {
  return {x.begin(), x.end()};
}

/// The characters of `x`, without a trailing NUL.
[[nodiscard]] inline bytes to_bytes(std::string_view x) {
  return {x.begin(), x.end()};
}

/// The octets as characters, embedded NULs included.
[[nodiscard]] inline std::string to_string(byte_view x) {
  return {x.begin(), x.end()};
}

/// Lower-case hexadecimal, two digits an octet, no blanks.
[[nodiscard]] std::string to_hex(byte_view x);

/// @returns nothing if `x` has an odd digit or a character that is neither blank nor hexadecimal
[[nodiscard]] std::optional<bytes> from_hex(std::string_view x);

/// Immutable octets with shared ownership: copying one copies a pointer, never the octets.
class payload {
public:
  payload() = default;
  payload(bytes octets); // NOLINT: an implicit conversion is what every sender wants

  /// `count` octets from `offset` on; they share, and keep, the storage of all. @pre they exist
  [[nodiscard]] payload part(std::size_t offset, std::size_t count) const;

  [[nodiscard]] byte_view view() const { return content_ ? content_->visible : byte_view(); }
  [[nodiscard]] std::size_t size() const { return view().size(); }
  [[nodiscard]] bool empty() const { return size() == 0; }

  friend bool operator==(const payload& a, const payload& b) {
    return a.size() == b.size() && std::equal(a.view().begin(), a.view().end(), b.view().begin());
  }

private:
  struct content {
    explicit content(bytes x) : octets(std::move(x)), visible(octets) {}
    content(std::shared_ptr<const content> whole, byte_view part)
        : owner(std::move(whole)), visible(part) {}
    content(const content&) = delete;
    content& operator=(const content&) = delete;

    bytes octets;
    std::shared_ptr<const content> owner; ///< of the octets, if not we
    byte_view visible;
  };

  std::shared_ptr<const content> content_;
};

} // namespace rubicon
