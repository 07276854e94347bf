// Names of tuples: dot-separated parts, compared without letter case (TUP-03, A-28).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/error.hpp"

namespace rubicon::peis {

inline constexpr std::size_t key_length_max = 127;
inline constexpr std::size_t key_parts_max = 7;

/// A key or a pattern. The part `*` stands for exactly one part; the empty key matches every key.
class key {
public:
  key() = default;

  /// What a user writes: too_long above 127 characters; bad_value above 7 parts or for a part that
  /// has `*` beside other characters.
  [[nodiscard]] static result<key> parse(std::string_view text);

  /// What came from the wire: text beyond the seventh part is dropped, `x*` is literal
  /// (peis-wire.md 15.7). too_long above 127 characters.
  [[nodiscard]] static result<key> from_wire(std::string_view text);

  [[nodiscard]] const std::string& text() const { return text_; }
  /// In lower case: equal for equal keys.
  [[nodiscard]] const std::string& folded() const { return folded_; }
  [[nodiscard]] std::size_t parts() const { return parts_; } ///< 0 for the empty key
  [[nodiscard]] bool is_pattern() const { return pattern_; }
  [[nodiscard]] bool any() const { return parts_ == 0; }

  /// Does this pattern cover `other`? Wildcards count on this side only.
  [[nodiscard]] bool matches(const key& other) const;

  friend bool operator==(const key& a, const key& b) { return a.folded_ == b.folded_; }

private:
  explicit key(std::string_view text);

  [[nodiscard]] static std::string_view first_parts(std::string_view text, std::size_t count);

  std::string text_;
  std::string folded_;
  std::size_t parts_ = 0;
  bool pattern_ = true;
};

} // namespace rubicon::peis
