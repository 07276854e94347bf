#include "io/kept_number.hpp"

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace rubicon::io {

namespace {

std::string reason() {
  return std::generic_category().message(errno);
}

/// Writes all of it, to the disk.
bool write_through(const std::string& path, const std::string& text) {
  const int to = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (to == -1)
    return false;
  const bool good = ::write(to, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                    ::fsync(to) == 0;
  const int error = errno;
  ::close(to);
  errno = error;
  return good;
}

} // namespace

std::variant<kept_number, std::string> kept_number::open(const std::string& path) {
  kept_number x(path);
  std::error_code error;
  if (!std::filesystem::exists(path, error) && !error)
    return x;
  std::ifstream in(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  while (text.ends_with('\n'))
    text.pop_back();
  const auto* const end = text.data() + text.size();
  const auto [stop, wrong] = std::from_chars(text.data(), end, x.value_);
  if (!in || wrong != std::errc{} || stop != end)
    return path + " holds no number: remove it if nothing of its ecology runs any more";
  return x;
}

std::string kept_number::keep(std::uint32_t x) {
  const auto next = path_ + ".new";
  if (!write_through(next, std::to_string(x) + '\n') ||
      std::rename(next.c_str(), path_.c_str()) != 0)
    return path_ + " cannot be written: " + reason();
  value_ = x;
  return {};
}

std::string state_file(const std::string& name) {
  const char* const given = std::getenv("XDG_STATE_HOME");
  const char* const home = std::getenv("HOME");
  std::filesystem::path folder;
  if (given != nullptr && *given == '/')
    folder = given;
  else if (home != nullptr && *home == '/')
    folder = std::filesystem::path(home) / ".local" / "state";
  else
    return {};
  folder /= "rubicon";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  return error ? std::string() : (folder / name).string();
}

} // namespace rubicon::io
