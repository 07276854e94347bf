#include "io/files/stored_number.hpp"

#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "io/files/replace_file.hpp"

namespace rubicon::io {

std::variant<stored_number, std::string> stored_number::open(const std::string& path) {
  stored_number x(path);
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
    return path + " contains no number: remove it if its ecology is no longer running";
  return x;
}

std::string stored_number::store(std::uint32_t x) {
  auto why = replace_file(path_, std::to_string(x) + '\n', durability::of_power);
  if (why.empty())
    value_ = x;
  return why;
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
