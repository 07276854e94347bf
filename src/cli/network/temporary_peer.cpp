#include "cli/network/temporary_peer.hpp"

#include <random>
#include <utility>

namespace rubicon::cli {

namespace {

constexpr std::int32_t temporary_id_min = 60'000;
constexpr duration quiet = 500ms; ///< some round trips over several hops

peer_id id_by_chance() {
  std::random_device device;
  std::uniform_int_distribution<std::int32_t> ids(temporary_id_min, peer_id_max);
  return peer_id{ids(device)};
}

} // namespace

std::variant<std::unique_ptr<temporary_peer>, std::string>
temporary_peer::join(io::loop& where, const network_options& options) {
  std::unique_ptr<temporary_peer> x(new temporary_peer);
  x->options_ = options;
  peer::standalone_config config;
  auto& network = config.kernel.network;
  network.id = options.id.value_or(id_by_chance());
  network.name = "rubicon-cli";
  network.network = options.network;
  network.connections.always = {options.peer};
  network.connections.leaf = true;
  network.connections.manager = false;
  config.links.first_port.reset();
  config.links.connect_timeout = options.timeout;
  network.connections.connect_timeout = options.timeout;
  config.on_warning = [y = x.get()](const std::string& text) { y->last_failure_ = text; };
  auto opened = peer::standalone::open(where, std::move(config));
  if (auto* refusal = std::get_if<std::string>(&opened))
    return std::move(*refusal);
  x->peer_ = std::move(std::get<std::unique_ptr<peer::standalone>>(opened));
  auto& peer = *x->peer_;
  const auto connected = [&] { return peer.kernel().counters().network.links_opened > 0; };
  peer.run_until(
      [&] {
        const bool refused = connected() && peer.links().open_links() == 0;
        return peer.network().hosts.records().size() > 1 || !x->last_failure_.empty() || refused;
      },
      options.timeout);
  if (peer.network().hosts.records().size() > 1)
    return x;
  if (!x->last_failure_.empty())
    return x->last_failure_;
  if (!connected())
    return options.peer + " does not answer";
  return options.peer + std::string(other_network) + options.network +
         "`: give the name that its file has as `network` with --network NAME";
}

temporary_peer::~temporary_peer() {
  if (peer_ && peer_->network().hosts.records().size() > 1)
    peer_->leave();
}

bool temporary_peer::await_host(peer_id host) {
  return peer_->run_until([&] { return peer_->network().reachable(host); }, options_.timeout);
}

bool temporary_peer::await_quiet(const std::function<bool()>& found,
                                 const std::function<std::size_t()>& news) {
  const auto end = peer_->now() + options_.timeout;
  auto seen = news();
  auto since = peer_->now();
  const auto is_quiet = [&] {
    if (std::exchange(seen, news()) != seen)
      since = peer_->now();
    return found() && peer_->now() - since >= quiet;
  };
  while (!is_quiet() && peer_->now() < end)
    peer_->step(20ms);
  return found();
}

} // namespace rubicon::cli
