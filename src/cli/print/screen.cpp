#include "cli/print/screen.hpp"

#include <cerrno>
#include <cstdio>
#include <cstdlib>

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "cli/print/console.hpp"

namespace rubicon::cli {

namespace {

constexpr std::size_t height_default = 24;

} // namespace

bool has_screen() {
  const char* const kind = std::getenv("TERM");
  return console_of(stdout).is_terminal && kind != nullptr && std::string_view(kind) != "dumb";
}

screen::screen() {
  termios now{};
  if (::isatty(STDIN_FILENO) == 1 && ::tcgetpgrp(STDIN_FILENO) == ::getpgrp() &&
      ::tcgetattr(STDIN_FILENO, &now) == 0) {
    before_ = now;
    now.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    now.c_cc[VMIN] = 0;
    now.c_cc[VTIME] = 0;
    now.c_cc[VSUSP] = _POSIX_VDISABLE; // a shell would get the screen as it is here
    static_cast<void>(::tcsetattr(STDIN_FILENO, TCSANOW, &now));
  }
  static_cast<void>(print(stdout, "\033[?1049h\033[?25l\033[H\033[J"));
}

screen::~screen() {
  static_cast<void>(print(stdout, "\033[?25h\033[?1049l"));
  if (before_)
    static_cast<void>(::tcsetattr(STDIN_FILENO, TCSANOW, &*before_));
}

bool screen::draw(std::string_view text) const {
  std::string out = "\033[H";
  const auto rows = height();
  for (std::size_t row = 0; row < rows && !text.empty(); ++row) {
    const auto end = text.find('\n');
    out += (row > 0 ? "\n" : "") + std::string(text.substr(0, end)) + "\033[K";
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return print(stdout, out + "\033[J");
}

std::optional<char> screen::key() const {
  pollfd keyboard{STDIN_FILENO, POLLIN, 0};
  char x = 0;
  if (!before_ || ::poll(&keyboard, 1, 0) != 1 || ::read(STDIN_FILENO, &x, 1) != 1)
    return std::nullopt;
  return x;
}

std::size_t screen::width() const {
  return console_of(stdout).width;
}

std::size_t screen::height() const {
  winsize size{};
  return ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0 ? size.ws_row
                                                                           : height_default;
}

} // namespace rubicon::cli
