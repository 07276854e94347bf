// Commands that are shown to people, who paste them into a shell.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rubicon {

/// One word of a shell, quoted where it must be.
[[nodiscard]] inline std::string shell_word(std::string_view x) {
  constexpr std::string_view harmless = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                        "0123456789_-./:=@%+,";
  if (!x.empty() && x.find_first_not_of(harmless) == std::string_view::npos)
    return std::string(x);
  std::string quoted = "'";
  for (const char c : x)
    quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// Words after others: ` --mode wall`; nothing for none.
[[nodiscard]] inline std::string shell_words(const std::vector<std::string>& all) {
  std::string text;
  for (const auto& each : all)
    text += ' ' + shell_word(each);
  return text;
}

} // namespace rubicon
