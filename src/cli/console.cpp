#include "cli/console.hpp"

#include <cstdlib>

#include <sys/ioctl.h>
#include <unistd.h>

namespace rubicon::cli {

console console_of(std::FILE* stream) {
  console x;
  const auto descriptor = fileno(stream);
  x.is_terminal = isatty(descriptor) == 1;
  if (!x.is_terminal)
    return x;
  const char* no_colour = std::getenv("NO_COLOR"); // https://no-color.org
  const char* kind = std::getenv("TERM");
  const bool is_dumb = kind == nullptr || std::string_view(kind) == "dumb";
  x.colour = !is_dumb && (no_colour == nullptr || *no_colour == '\0');
  winsize size{};
  if (ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
    x.width = size.ws_col;
  return x;
}

bool print(std::FILE* stream, std::string_view text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  return std::fflush(stream) == 0 && written;
}

} // namespace rubicon::cli
