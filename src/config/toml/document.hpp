// A TOML file as a tree with places. Only document.cpp knows which library parses it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "config/toml/problem.hpp"

namespace rubicon::config {

struct member;
struct node;
using node_table = std::vector<member>; ///< in the order of the file, keys unique
using node_array = std::vector<node>;

/// A date or a time: well-formed TOML that no key of ours takes.
struct date_or_time {};

/// A value and where it begins; of a table under a header, where the header begins.
struct node {
  mark at;
  std::variant<node_table, node_array, std::string, std::int64_t, double, bool, date_or_time>
      content;

  template <class T>
  [[nodiscard]] const T* as() const {
    return std::get_if<T>(&content);
  }

  /// The value of a key of this table; nullptr if there is none or this is no table.
  [[nodiscard]] const node* find(std::string_view key) const;
};

struct member {
  std::string key;
  mark at; ///< of the key
  node value;
};

/// What a reader calls the content in a complaint: `300`, `"micaz"`, `a table`.
[[nodiscard]] std::string describe(const node& x);

/// `x` between quotation marks, cut when it is long.
[[nodiscard]] std::string in_quotes(std::string_view x);

/// The shortest decimal that means `x`: `2.5`, `100000`, `1e+20`.
[[nodiscard]] std::string shown(double x);

/// What some editors write before the text; it means nothing.
inline constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

/// A table without keys.
inline const node no_keys{{}, node_table{}};

/// A larger file is refused.
inline constexpr std::size_t file_octets_max = 16 * 1024 * 1024;

/// The root table, or the first problem: with its place for a syntax error, with line 0 for octets
/// that are no text at all, and for a file without any content.
[[nodiscard]] std::variant<node, problem> parse(std::string_view text, const std::string& file);

} // namespace rubicon::config
