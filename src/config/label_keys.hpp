// The key `label` of whatever may have one.
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "config/plan/labels.hpp"
#include "config/toml/table_reader.hpp"
#include "config/toml/values.hpp"
#include "core/text/name.hpp"
#include "core/text/printable.hpp"

namespace rubicon::config {

/// Text that a terminal shows as it is: any UTF-8, but no control characters.
struct label_text {
  using type = std::string;

  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who) {
    const auto* found = x.as<std::string>();
    if (found == nullptr || found->empty() || found->size() > label_octets_max ||
        printable(*found) != *found)
      return who.refuse(x, "a text of 1 to " + std::to_string(label_octets_max) +
                               " octets of UTF-8 without control characters");
    return *found;
  }
  [[nodiscard]] static form takes() { return form_of(text{label_octets_max}); }
};

/// A name of what may have a label, too.
struct labelled_name {
  using type = std::string;

  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who) {
    const auto* found = x.as<std::string>();
    if (found != nullptr && is_name(*found))
      return *found;
    return who.refuse(x, "a name of 1 to 32 letters, digits, - and _",
                      found == nullptr ? std::string() : advice(*found));
  }
  [[nodiscard]] static form takes() { return form_of(name_text{}); }

private:
  /// Where a text can stand that has words, or letters of other languages; empty for another one.
  [[nodiscard]] static std::string advice(std::string text) {
    const bool is_label = std::ranges::any_of(
        text, [](char c) { return c == ' ' || static_cast<unsigned char>(c) >= 0x80; });
    if (!is_label)
      return {};
    const std::string label = text;
    std::ranges::replace(text, ' ', '-');
    if (!is_name(text) || printable(label) != label)
      return ": `label` takes any text";
    return ": give `name = \"" + text + "\"` and `label = \"" + label + "\"`";
  }
};

struct labelled {
  std::string label;
};

inline auto label_keys() {
  return keys::of(keys::optional("label", &labelled::label, label_text{},
                                 {"what people call it, shown beside its name in reports, "
                                  "explanations and pages; any characters, spaces too",
                                  "none"}));
}

/// @returns the label in a table; empty: none
[[nodiscard]] inline std::string read_label(table_reader& in) {
  labelled out;
  in.all(out, label_keys());
  return out.label;
}

} // namespace rubicon::config
