#include "cli/words/hint.hpp"

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

namespace rubicon::cli {

std::string with_hint(const std::string& x) {
  constexpr std::array<std::pair<int, const char*>, 6> hints{{
      {ENOENT, "; correct the path, or create its folder first"},
      {ENOTDIR, "; a part of the path is a file: correct it"},
      {EISDIR, "; it is a folder: give the name of a file in it"},
      {EACCES, "; choose a place that you may write to, or change its permissions"},
      {EROFS, "; choose a place that can be written to"},
      {ENOSPC, "; free some space, or choose another disk"},
  }};
  for (const auto& [error, hint] : hints)
    if (x.ends_with(std::generic_category().message(error)))
      return x + hint;
  return x;
}

} // namespace rubicon::cli
