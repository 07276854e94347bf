// Names of tuples: dot-separated parts, compared without letter case (TUP-03, A-28).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "core/error.hpp"
#include "core/tuples/tuple_key.hpp"

namespace rubicon::peis {

/// A key or a pattern. The part `*` stands for exactly one part; the empty key matches every key.
/// Copies share their text.
class key {
public:
  key() = default;

  /// What a user writes: too_long above 127 characters; bad_value above 7 parts or for a part that
  /// has `*` beside other characters.
  [[nodiscard]] static result<key> parse(std::string_view text);

  /// What came from the wire: text beyond the seventh part is dropped, `x*` is literal
  /// (peis-wire.md 15.7). too_long above 127 characters.
  [[nodiscard]] static result<key> from_wire(std::string_view text);

  [[nodiscard]] const std::string& text() const { return content().text; }
  /// In lower case: equal for equal keys.
  [[nodiscard]] const std::string& folded() const {
    const auto& x = content();
    return x.folded ? *x.folded : x.text;
  }
  [[nodiscard]] std::size_t parts() const { return content_ ? content_->parts : 0; } ///< 0: empty
  [[nodiscard]] bool is_pattern() const { return !content_ || content_->wild_at != no_wildcard; }
  [[nodiscard]] bool any() const { return parts() == 0; }

  /// The folded characters before the first wildcard: all keys that match begin with them.
  [[nodiscard]] std::string_view literal_prefix() const {
    return std::string_view(folded()).substr(0, content_ ? content_->wild_at : 0);
  }

  /// Does this pattern cover `other`? Wildcards count on this side only.
  [[nodiscard]] bool matches(const key& other) const;

  friend bool operator==(const key& a, const key& b) {
    return a.content_ == b.content_ || a.folded() == b.folded();
  }

private:
  static constexpr std::uint8_t no_wildcard = 255; ///< no key is so long

  struct parsed {
    std::string text;
    std::unique_ptr<const std::string> folded; ///< nullptr: as the text
    std::uint8_t parts = 0;
    std::uint8_t wild_at = no_wildcard; ///< where the first wildcard stands
  };

  explicit key(std::string_view text);

  [[nodiscard]] const parsed& content() const;
  [[nodiscard]] static std::string_view first_parts(std::string_view text, std::size_t count);

  std::shared_ptr<const parsed> content_; ///< unset for the empty key
};

/// By folded text, which may stand for a key.
struct key_order {
  using is_transparent = void;

  bool operator()(const key& a, const key& b) const { return a.folded() < b.folded(); }
  bool operator()(const key& a, std::string_view b) const { return a.folded() < b; }
  bool operator()(std::string_view a, const key& b) const { return a < b.folded(); }
};

/// Does it name what describes a kernel, which others may not write (TUP-22)?
[[nodiscard]] bool is_reserved(const key& name);

/// The reserved tuple by which some others may stop a peer (TUP-22).
inline constexpr std::string_view quit_key = "kernel.do-quit";

/// Equal up to letter case of the 26 ASCII letters.
[[nodiscard]] bool equal_without_case(std::string_view a, std::string_view b);

} // namespace rubicon::peis
