// What a bridge knows of the objects of a proxy class: which tuples they have, and what these mean.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proxy/classes/proxy_class.hpp"

namespace rubicon::bridge {

/// A reading of an object, tuple `PREFIX.NAME`.
struct field_model {
  std::string name;
  std::string unit;               ///< empty: none
  std::vector<std::string> words; ///< not empty: the value is one of these instead of a number
  int decimals = 1;
};

/// What an input accepts beside words.
struct number_range {
  double min = 0;
  double max = 0;
  double step = 1;
};

/// An input of an object, tuple `PREFIX.NAME`, with its outcome in `PREFIX.NAME.outcome`.
struct input_model {
  std::string name;
  std::string unit;
  std::vector<std::string> words;
  std::optional<number_range> numbers = {};
};

struct class_model {
  std::string name;
  std::string pattern; ///< of the prefixes of its objects; a part may be `*`
  std::vector<field_model> fields;
  std::vector<input_model> inputs;
};

[[nodiscard]] class_model model_of(const proxy::proxy_class& x);

/// @returns the input with that name, in any letter case; nullptr if there is none
[[nodiscard]] const input_model* input_of(const class_model& x, std::string_view name);

/// What the input receives for this text: a word in the class's spelling, or the number.
/// @returns nothing if the input accepts neither
[[nodiscard]] std::optional<std::string> accepted(const input_model& x, std::string_view text);

/// The suffixes, after `PREFIX.`, of all tuples of such an object that a bridge reads.
[[nodiscard]] std::vector<std::string> suffixes_of(const class_model& x);

/// In lower case, of ASCII letters.
[[nodiscard]] std::string folded(std::string_view x);

} // namespace rubicon::bridge
