#include "io/serial/port_holders.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

namespace rubicon::io {

namespace fs = std::filesystem;

namespace {

bool is_number(const std::string& x) {
  return !x.empty() && std::ranges::all_of(x, [](char c) { return c >= '0' && c <= '9'; });
}

/// Whether the process has the terminal of that number. What it closes meanwhile it has not.
bool has_open(const fs::path& process, dev_t terminal) {
  std::error_code error;
  for (fs::directory_iterator x(process / "fd", error), end; !error && x != end;
       x.increment(error)) {
    struct stat each {};
    if (::stat(x->path().c_str(), &each) == 0 && S_ISCHR(each.st_mode) && each.st_rdev == terminal)
      return true;
  }
  return false;
}

std::string name_in(const fs::path& process) {
  std::ifstream in(process / "comm");
  std::string name;
  std::getline(in, name);
  return name.empty() ? "a program" : name;
}

} // namespace

std::string holder_of_terminal(const std::string& path) {
  struct stat port {};
  constexpr unsigned memory = 1; // its devices, as /dev/null, are no terminals
  if (::stat(path.c_str(), &port) != 0 || !S_ISCHR(port.st_mode) || major(port.st_rdev) == memory)
    return {};
  const auto own = std::to_string(::getpid());
  std::error_code error;
  for (fs::directory_iterator x("/proc", error), end; !error && x != end; x.increment(error)) {
    const auto id = x->path().filename().string();
    // Twice: whoever only makes it ready, as a pseudo-terminal's maker does, has it for a moment.
    if (is_number(id) && id != own && has_open(x->path(), port.st_rdev) &&
        has_open(x->path(), port.st_rdev))
      return name_in(x->path()) + " (process " + id + ')';
  }
  return {};
}

} // namespace rubicon::io
