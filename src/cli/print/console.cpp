#include "cli/print/console.hpp"

#include <charconv>
#include <cstdlib>
#include <system_error>

#include <sys/ioctl.h>
#include <unistd.h>

#include "core/text/printable.hpp"

namespace rubicon::cli {

namespace {

/// What COLUMNS says; 0: nothing that makes sense.
std::size_t columns_wanted() {
  const char* const text = std::getenv("COLUMNS");
  if (text == nullptr)
    return 0;
  const std::string_view digits(text);
  std::size_t columns = 0;
  const auto [stop, error] = std::from_chars(text, text + digits.size(), columns);
  return error == std::errc{} && stop == text + digits.size() ? columns : 0;
}

} // namespace

console console_of(std::FILE* stream) {
  console x;
  const auto descriptor = fileno(stream);
  x.is_terminal = isatty(descriptor) == 1;
  if (!x.is_terminal) {
    const auto columns = columns_wanted();
    x.cuts = columns > 0;
    x.width = columns > 0 ? columns : x.width;
    return x;
  }
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

void say(std::string_view text) {
  static_cast<void>(print(stderr, printable(text) + '\n'));
}

exit_status refuse(std::string_view why) {
  say("rubicon: " + std::string(why));
  return exit_status::refused;
}

} // namespace rubicon::cli
