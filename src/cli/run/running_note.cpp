#include "cli/run/running_note.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/text/json.hpp"
#include "io/files/replace_file.hpp"
#include "io/files/stored_number.hpp"

namespace rubicon::cli {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* running_ending = ".running";
constexpr std::size_t urls_stored_max = 64; ///< of one run

/// The address at which this computer reaches what listens at `listened`.
std::string own_address(const std::string& listened) {
  return listened.empty() || listened == "0.0.0.0" ? "127.0.0.1" : listened;
}

bool is_alive(const fs::path& note) {
  const auto name = note.stem().string();
  pid_t process = 0;
  const auto* const end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data(), end, process);
  if (error != std::errc{} || stop != end || process <= 0)
    return false;
  return ::kill(process, 0) == 0 || errno == EPERM;
}

std::optional<running_ecology> read_note(const fs::path& path) {
  std::ifstream in(path);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  try {
    const auto all = parse_json(text);
    return running_ecology{all.at("ecology"), all.at("network"),
                           all.at("urls").get<std::vector<std::string>>()};
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

/// By the notes with this ending, without those of processes that are gone.
std::vector<running_ecology> noted_ecologies(const std::string& ending) {
  std::vector<running_ecology> all;
  const auto one = io::state_file("x");
  if (one.empty())
    return all;
  std::error_code error;
  for (const auto& each : fs::directory_iterator(fs::path(one).parent_path(), error)) {
    if (each.path().extension() != ending)
      continue;
    if (ending == running_ending && !is_alive(each.path())) {
      static_cast<void>(std::remove(each.path().c_str())); // its process was killed
      continue;
    }
    if (auto found = read_note(each.path()); found && all.size() < running_max)
      all.push_back(*std::move(found));
  }
  std::ranges::sort(all, [](const auto& a, const auto& b) { return a.name < b.name; });
  return all;
}

} // namespace

running_note::running_note(const config::ecology_description& x) {
  json urls = json::array();
  bool takes_links = false;
  for (const auto& peer : x.peers) {
    takes_links = takes_links || peer.tcp || peer.lan;
    if (peer.tcp && peer.tcp->port && urls.size() < urls_stored_max)
      urls.push_back("tcp://" + own_address(peer.tcp->address) + ':' +
                     std::to_string(*peer.tcp->port));
  }
  if (!takes_links)
    return;
  const auto path = io::state_file(std::to_string(::getpid()) + running_ending);
  const json all{{"ecology", x.name}, {"network", x.network}, {"urls", urls}};
  if (!path.empty() && io::replace_file(path, json_line(all) + '\n').empty())
    path_ = path;
}

running_note::~running_note() {
  if (!path_.empty())
    static_cast<void>(std::remove(path_.c_str()));
}

std::vector<running_ecology> running_ecologies() {
  return noted_ecologies(running_ending);
}

std::vector<running_ecology> deployed_ecologies() {
  return noted_ecologies(deployed_ending);
}

} // namespace rubicon::cli
