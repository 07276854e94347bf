#include "io/files/secret_file.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace rubicon::io {

namespace {

constexpr std::size_t secret_octets_max = 4096;

std::variant<std::string, no_secret> secret_behind(int descriptor, const std::string& path) {
  struct stat about {};
  if (::fstat(descriptor, &about) != 0 || !S_ISREG(about.st_mode))
    return no_secret{path + ": not a regular file"};
  if ((about.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return no_secret{path + ": other users have access to this file: run chmod 600, and change "
                            "the password if it may have been read"};
  std::array<char, secret_octets_max + 1> octets{};
  const auto got = ::read(descriptor, octets.data(), octets.size());
  if (got < 0 || static_cast<std::size_t>(got) > secret_octets_max)
    return no_secret{path + (got < 0 ? ": cannot be read" : ": larger than 4096 octets")};
  const std::string_view text(octets.data(), static_cast<std::size_t>(got));
  auto line = text.substr(0, text.find_first_of("\r\n"));
  if (line.empty() || line.find('\0') != std::string_view::npos)
    return no_secret{path + ": its first line is empty, or no text"};
  return std::string(line);
}

} // namespace

std::variant<std::string, no_secret> read_secret(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0)
    return no_secret{path + ": " + std::generic_category().message(errno)};
  auto out = secret_behind(descriptor, path);
  ::close(descriptor);
  return out;
}

std::variant<std::string, no_secret> secret_in_environment(const char* name) {
  const char* const found = std::getenv(name);
  if (found == nullptr || *found == '\0')
    return no_secret{"the environment variable " + std::string(name) + " is not set"};
  return std::string(found);
}

} // namespace rubicon::io
