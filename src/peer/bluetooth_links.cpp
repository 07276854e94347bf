#include "peer/bluetooth_links.hpp"

#include <algorithm>
#include <utility>

#include "peis/link/link.hpp"
#include "peis/media/simulated_bluetooth.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peer {

namespace {

constexpr std::size_t ports_max = 16; ///< peers that share an adapter

/// A package, or what comes before the first one.
std::size_t size_of_first(byte_view octets) {
  const auto header = peis::decode_header(octets);
  const auto size = header ? peis::header_size + header->length : peis::connect_request_size;
  return std::min(size, octets.size());
}

} // namespace

bluetooth_links::bluetooth_links(io::loop& where, bluetooth_links_config config,
                                 std::unique_ptr<io::bluetooth_adapter> adapter, link_user& user,
                                 adapter_user& watcher)
    : loop_(&where), config_(std::move(config)), adapter_(std::move(adapter)), user_(&user),
      hellos_(where, *adapter_, {config_.adapter, config_.connect_timeout, config_.hello_timeout},
              watcher),
      scanner_(where, *adapter_, config_.adapter, watcher), next_link_(config_.first_link.value) {}

std::variant<std::unique_ptr<bluetooth_links>, std::string>
bluetooth_links::open(io::loop& where, bluetooth_links_config config,
                      std::unique_ptr<io::bluetooth_adapter> adapter, link_user& user,
                      adapter_user& watcher) {
  std::unique_ptr<bluetooth_links> x(
      new bluetooth_links(where, std::move(config), std::move(adapter), user, watcher));
  if (auto refusal = x->listen())
    return *std::move(refusal);
  return x;
}

std::optional<std::string> bluetooth_links::listen() {
  auto error = std::make_error_code(std::errc::address_in_use);
  for (std::size_t i = 0; i < ports_max && !listener_; ++i) {
    port_ = peis::bluetooth_port(i);
    auto x = adapter_->listen(port_);
    if (auto* socket = std::get_if<io::descriptor>(&x))
      listener_.emplace(*loop_, std::move(*socket),
                        [this](io::descriptor y) { on_connection(std::move(y)); });
    else if (error = std::get<std::error_code>(x);
             error != std::make_error_condition(std::errc::address_in_use))
      break;
  }
  if (!listener_)
    return "cannot listen at Bluetooth adapter " + config_.adapter + ": " + error.message();
  hellos_.listen();
  return std::nullopt;
}

peis::low_level_address bluetooth_links::address() const {
  return peis::bluetooth_interface(config_.adapter, {adapter_->address()}, port_);
}

// Links.

void bluetooth_links::on_connection(io::descriptor x) {
  if (streams_.size() >= links_max)
    ++counters_.refused; // dropped
  else
    add(std::move(x), peis::link_role::acceptor, std::nullopt);
}

void bluetooth_links::add(io::descriptor x, peis::link_role role,
                          std::optional<peis::attempt_id> attempt) {
  const peis::link_id link{next_link_++};
  auto& stream = streams_[link] = io::packet_stream(*loop_, std::move(x), room);
  stream.start({[this, link](byte_view octets) { user_->on_link_octets(link, octets); },
                [this, link](std::size_t octets) { user_->on_link_sent(link, octets); },
                [this, link](const std::string& why) {
                  streams_.erase(link);
                  user_->on_link_closed(link, why);
                }});
  user_->on_link_open(link, role, attempt);
}

void bluetooth_links::carry_out(const peis::to_link& x) {
  const auto found = streams_.find(x.link);
  if (found == streams_.end())
    return;
  for (std::size_t at = 0; at < x.octets.size();) {
    const auto size = size_of_first(x.octets.view().subspan(at));
    send(x.link, found->second, x.octets.part(at, size));
    at += size;
  }
}

/// What has no room is lost as a whole package, so that the other side can read on.
void bluetooth_links::send(peis::link_id link, io::packet_stream& over, payload package) {
  const auto size = package.size();
  if (over.send(std::move(package)))
    return;
  ++counters_.dropped;
  loop_->post([this, link, size, alive = std::weak_ptr(alive_)] {
    if (!alive.expired() && streams_.contains(link))
      user_->on_link_sent(link, size);
  });
}

void bluetooth_links::carry_out(const peis::close_link& x) {
  auto found = streams_.extract(x.link);
  using peis::close_cause;
  const bool at_once = x.why == close_cause::handshake_silent || x.why == close_cause::silent ||
                       x.why == close_cause::replaced || *closing_ >= closing_max;
  if (found.empty() || at_once)
    return; // dropped
  ++*closing_;
  found.mapped().close([closing = closing_] { --*closing; });
}

void bluetooth_links::carry_out(const peis::read_link& x) {
  const auto found = streams_.find(x.link);
  if (found != streams_.end())
    found->second.read(x.wanted);
}

void bluetooth_links::carry_out(const peis::connect_to& x) {
  if (over_)
    return;
  const auto url = peis::parse_link_url(x.url);
  const auto device = url ? peis::bluetooth_device(*url) : std::nullopt;
  if (!device) {
    fail_soon(x.attempt, x.url + ": not an address of Bluetooth");
    return;
  }
  if (attempts_.size() >= attempts_max) {
    ++counters_.too_many;
    fail_soon(x.attempt, x.url + ": too many simultaneous attempts");
    return;
  }
  auto socket = adapter_->connect(device->octets, url->port);
  if (const auto* error = std::get_if<std::error_code>(&socket))
    fail_soon(x.attempt, x.url + ": " + error->message());
  else
    attempts_.emplace(x.attempt,
                      io::packet_connect(*loop_, std::move(std::get<io::descriptor>(socket)),
                                         config_.connect_timeout,
                                         [this, attempt = x.attempt, to = x.url](auto y) {
                                           on_attempt(attempt, to, std::move(y));
                                         }));
}

void bluetooth_links::on_attempt(peis::attempt_id attempt, const std::string& url,
                                 std::variant<io::descriptor, std::string> x) {
  const auto ended = attempts_.extract(attempt); // lives until this call is over
  if (const auto* why = std::get_if<std::string>(&x))
    user_->on_attempt_failed(attempt, url + ": " + *why);
  else
    add(std::move(std::get<io::descriptor>(x)), peis::link_role::initiator, attempt);
}

void bluetooth_links::fail_soon(peis::attempt_id attempt, std::string why) {
  loop_->post([this, attempt, why = std::move(why), alive = std::weak_ptr(alive_)] {
    if (!alive.expired() && !over_)
      user_->on_attempt_failed(attempt, why);
  });
}

// HELLOs and scans.

void bluetooth_links::carry_out(const peis::say_hello& x) {
  if (!over_)
    hellos_.say(x);
}

void bluetooth_links::carry_out(const peis::scan_adapter& x) {
  if (!over_ && x.adapter == config_.adapter)
    scanner_.start(config_.inquiry);
}

bluetooth_counters bluetooth_links::counters() const {
  auto x = counters_;
  x.hellos_lost = hellos_.lost();
  x.scans_failed = scanner_.failed();
  return x;
}

void bluetooth_links::close_all() {
  over_ = true;
  listener_.reset();
  attempts_.clear();
  hellos_.close();
  scanner_.stop();
  for (auto& [link, x] : streams_) {
    if (*closing_ >= closing_max)
      continue; // dropped
    ++*closing_;
    x.close([closing = closing_] { --*closing; });
  }
  streams_.clear();
}

} // namespace rubicon::peer
