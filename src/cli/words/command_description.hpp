// The commands and their options, as data: for pages of the manual and completion in shells.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rubicon::cli {

/// What a shell may complete a value with.
enum class completes : std::uint8_t { nothing, words, files, folders };

/// An option or an argument.
struct option_description {
  std::vector<std::string> names{}; ///< `--for`; of an argument one without dashes: `FILE`
  std::string value{};              ///< `TIME`; empty: a flag or an argument
  std::string meaning{};
  std::vector<std::string> words{};    ///< that the value is one of; empty: any
  std::string range{};                 ///< `1 to 256`; empty: any
  std::vector<std::string> needs{};    ///< names of other options, sorted
  std::vector<std::string> excludes{}; ///< as `needs`
  completes with = completes::nothing;
  bool is_required = false;
  bool is_repeatable = false;
  bool has_optional_value = false; ///< `--view`, `--view 8080`
};

struct command_description {
  std::vector<std::string> words{}; ///< `tuples`, `set`; none: the binary itself
  std::string sentence{};
  std::vector<option_description> arguments{};
  std::vector<option_description> options{};
  std::vector<command_description> commands{};
  std::string footer{}; ///< lines

  /// `tuples set`
  [[nodiscard]] std::string name(char between = ' ') const {
    std::string out;
    for (const auto& word : words)
      out += (out.empty() ? "" : std::string(1, between)) + word;
    return out;
  }
};

} // namespace rubicon::cli
