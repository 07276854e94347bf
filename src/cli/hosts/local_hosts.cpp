#include "cli/hosts/local_hosts.hpp"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <variant>

#include "cli/own_binary.hpp"
#include "cli/print/console.hpp"
#include "cli/words/exit_status.hpp"
#include "core/text/printable.hpp"
#include "core/time.hpp"
#include "io/tls/certificates.hpp"

namespace rubicon::cli {

namespace {

constexpr duration restart_pause = 1s;

void need(std::variant<io::made_certificate, std::string> made) {
  if (const auto* why = std::get_if<std::string>(&made))
    throw std::runtime_error(*why);
}

} // namespace

local_hosts::local_hosts(io::loop& loop, const std::vector<deployed_host>& hosts) : loop_(loop) {
  const auto folder = (folder_.path() / "certs").string();
  const auto now = io::system_time();
  need(io::make_authority(folder, {}, now));
  while (std::ranges::find(hosts, coordinator_, &deployed_host::name) != hosts.end())
    coordinator_ += '-';
  need(io::make_certificate(folder, {.host = coordinator_, .use = io::certificate_use::coordinator},
                            now));
  for (const auto& place : hosts) {
    auto& x = hosts_.emplace_back();
    x.place = place;
    need(io::make_certificate(folder, {.host = place.name, .use = io::certificate_use::host}, now));
    start(x);
  }
}

local_hosts::~local_hosts() = default;

control::tls_files local_hosts::certificate_of(const std::string& name) const {
  const auto file = [this](const std::string& x) {
    return (folder_.path() / "certs" / x).string();
  };
  return {file(name + ".crt"), file(name + ".key"), file(std::string(io::authority_name) + ".crt")};
}

void local_hosts::start(local_host& x) {
  const auto tls = certificate_of(x.place.name);
  io::spawn_request what;
  what.program = own_binary;
  what.words = {"rubicon",          "host",
                "--name",           x.place.name,
                "--listen",         x.place.address + ':' + std::to_string(x.place.port),
                "--state",          folder_.path().string(),
                "--tls-cert",       tls.certificate,
                "--tls-key",        tls.key,
                "--tls-ca",         tls.authority,
                "--allow-commands", "--allow-firmware",
                "--allow-devices",  "*",
                "--files",          std::filesystem::current_path().string()};
  // What a host says is said by its deployment as well; what keeps it from beginning, by it alone.
  auto begun = io::process::start(loop_, std::move(what),
                                  {[](io::process::output, byte_view) {},
                                   [this, &x](io::process_end) {
                                     x.process.reset();
                                     x.starts_at = steady::now() + restart_pause;
                                   }});
  if (const auto* why = std::get_if<std::string>(&begun))
    throw std::runtime_error(*why);
  x.process.emplace(std::get<io::process>(std::move(begun)));
}

void local_hosts::on_time() {
  for (auto& each : hosts_)
    if (!each.process && steady::now() >= each.starts_at)
      start(each);
}

} // namespace rubicon::cli
