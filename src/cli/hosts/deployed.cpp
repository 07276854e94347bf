#include "cli/hosts/deployed.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include <nlohmann/json.hpp>

#include "cli/run/running_note.hpp"
#include "config/plan/placement.hpp"
#include "core/text/json.hpp"
#include "io/files/replace_file.hpp"
#include "io/files/stored_number.hpp"

namespace rubicon::cli {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::optional<deployed> read_deployed(const fs::path& path) {
  std::ifstream in(path);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  try {
    const auto all = parse_json(text);
    deployed x{all.at("id"),
               all.at("ecology"),
               all.at("file"),
               {},
               {all.at("certificate"), all.at("key"), all.at("authority")}};
    for (const auto& host : all.at("hosts"))
      x.hosts.push_back({host.at("name"), host.at("address"), host.at("port")});
    return x;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

fs::path newest() {
  fs::path found;
  fs::file_time_type when;
  std::error_code error;
  const auto folder = fs::path(io::state_file("x")).parent_path();
  for (const auto& each : fs::directory_iterator(folder, error)) {
    if (each.path().extension() != deployed_ending)
      continue;
    const auto written = each.last_write_time(error);
    if (found.empty() || written > when) {
      found = each.path();
      when = written;
    }
  }
  return found;
}

} // namespace

std::vector<deployed_host> hosts_of(const config::ecology_description& all) {
  std::vector<deployed_host> out;
  for (const auto& host : config::used_hosts(all))
    out.push_back({host.name, host.address, host.control_port, host.peis_port});
  return out;
}

std::string remember(const deployed& x) {
  json hosts = json::array();
  for (const auto& host : x.hosts)
    hosts.push_back({{"name", host.name}, {"address", host.address}, {"port", host.port}});
  json urls = json::array(); // as in the note of a run
  for (const auto& host : x.hosts)
    if (host.peis_port != 0)
      urls.push_back("tcp://" + host.address + ':' + std::to_string(host.peis_port));
  const json all{{"id", x.id},           {"ecology", x.ecology},
                 {"file", x.file},       {"certificate", x.tls.certificate},
                 {"key", x.tls.key},     {"authority", x.tls.authority},
                 {"network", x.network}, {"hosts", hosts},
                 {"urls", urls}};
  const auto path = io::state_file(x.ecology + deployed_ending);
  if (path.empty())
    return "there is no folder to store the deployment's name in";
  return io::replace_file(path, json_lines(all) + '\n');
}

void forget(const deployed& x) {
  const auto path = io::state_file(x.ecology + deployed_ending);
  if (const auto found = read_deployed(path); found && found->id == x.id)
    static_cast<void>(std::remove(path.c_str()));
}

std::optional<deployed> remembered(const std::string& ecology) {
  const auto path =
      ecology.empty() ? newest() : fs::path(io::state_file(ecology + deployed_ending));
  return path.empty() ? std::nullopt : read_deployed(path);
}

} // namespace rubicon::cli
