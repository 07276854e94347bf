#include "cli/print/console.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

#include <sys/ioctl.h>
#include <unistd.h>

#include "core/text/printable.hpp"

namespace rubicon::cli {

namespace {

constexpr std::size_t columns_max = 1000;

/// What COLUMNS says, at most columns_max; 0: nothing that makes sense.
std::size_t columns_wanted() {
  const char* const text = std::getenv("COLUMNS");
  if (text == nullptr)
    return 0;
  const std::string_view digits(text);
  std::size_t columns = 0;
  const auto [stop, error] = std::from_chars(text, text + digits.size(), columns);
  return error == std::errc{} && stop == text + digits.size() ? std::min(columns, columns_max) : 0;
}

/// Once. A reader of standard output that has gone needs no reason.
void report_failure(std::FILE* stream, int why) {
  static bool is_reported = false;
  if (stream == stdout && why != EPIPE && !std::exchange(is_reported, true))
    say("rubicon: standard output cannot be written: " + std::generic_category().message(why));
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
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  const bool is_good = std::fflush(stream) == 0 && written;
  if (!is_good)
    report_failure(stream, errno);
  return is_good;
}

void say(std::string_view text) {
  static_cast<void>(print(stderr, printable(text) + '\n'));
}

exit_status refuse(std::string_view why) {
  say("rubicon: " + std::string(why));
  return exit_status::refused;
}

} // namespace rubicon::cli
