#include "peer/tcp_links.hpp"

#include <algorithm>
#include <utility>

#include "io/process/machine.hpp"

namespace rubicon::peer {

namespace {

const std::string everywhere = "0.0.0.0";
const std::string here = "127.0.0.1";

std::string dotted(const std::array<std::uint8_t, 4>& x) {
  auto text = std::to_string(x[0]);
  for (std::size_t i = 1; i < x.size(); ++i)
    text += '.' + std::to_string(x[i]);
  return text;
}

} // namespace

tcp_links::tcp_links(io::loop& where, links_config config, link_user& user)
    : loop_(&where), config_(std::move(config)), user_(&user),
      next_link_(config_.first_link.value) {}

std::variant<std::unique_ptr<tcp_links>, std::string>
tcp_links::open(io::loop& where, links_config config, link_user& user) {
  std::unique_ptr<tcp_links> x(new tcp_links(where, std::move(config), user));
  if (auto refusal = x->listen())
    return *std::move(refusal);
  if (auto refusal = x->open_udp())
    return *std::move(refusal);
  if (x->config_.lan)
    x->join_group();
  return x;
}

const std::string& tcp_links::listen_address() const {
  if (!config_.listen_address.empty())
    return config_.listen_address;
  return config_.lan ? everywhere : here;
}

std::optional<std::string> tcp_links::listen() {
  if (!config_.first_port)
    return std::nullopt;
  auto x = io::tcp_listener::open(
      *loop_, listen_address(), *config_.first_port,
      [this](io::tcp_stream y, const ipv4_address& from) { on_connection(std::move(y), from); });
  if (auto* refusal = std::get_if<std::string>(&x))
    return std::move(*refusal);
  listener_ = std::move(std::get<io::tcp_listener>(x));
  return std::nullopt;
}

std::optional<std::string> tcp_links::open_udp() {
  if (!config_.udp)
    return std::nullopt;
  auto x = udp_links::open(*loop_,
                           {listener_ ? listen_address() : everywhere, port(), config_.networks,
                            config_.connect_timeout},
                           *user_, [this] { return peis::link_id{next_link_++}; });
  if (auto* refusal = std::get_if<std::string>(&x))
    return std::move(*refusal);
  udp_ = std::move(std::get<std::unique_ptr<udp_links>>(x));
  return std::nullopt;
}

void tcp_links::join_group() {
  auto config = config_.group;
  if (config.interfaces.empty() && listen_address() != everywhere)
    config.interfaces = {listen_address()};
  auto x =
      io::udp_group::join(*loop_, config, [this](byte_view datagram, const ipv4_address& from) {
        if (is_listed(from))
          user_->on_announcement(datagram, from);
        else
          ++counters_.foreign;
      });
  if (auto* refusal = std::get_if<std::string>(&x)) {
    warning_ = *refusal;
    return;
  }
  group_ = std::move(std::get<io::udp_group>(x));
  group_->on_change([this] { user_->on_addresses(); });
}

std::string tcp_links::warning() const {
  const auto why = group_ ? group_->trouble() : warning_;
  return why.empty() ? why : "no announcements: " + why;
}

std::vector<peis::low_level_address> tcp_links::addresses() const {
  std::vector<peis::low_level_address> all;
  if (!listener_)
    return all;
  auto interfaces = io::network_interfaces();
  if (listen_address() != everywhere)
    std::erase_if(interfaces, [this](const auto& x) { return listen_address() != dotted(x.ipv4); });
  for (const auto& x : interfaces)
    all.push_back(peis::tcp_address(x.device, x.loopback, x.ipv4, listener_->port()));
  for (const auto& x : interfaces) {
    if (udp_)
      all.push_back(peis::udp_interface(x.device, x.loopback, x.ipv4, udp_->port()));
  }
  if (all.size() > peis::low_level_addresses_max)
    all.resize(peis::low_level_addresses_max);
  return all;
}

std::optional<std::uint16_t> tcp_links::udp_port() const {
  return udp_ ? std::optional(udp_->port()) : std::nullopt;
}

std::optional<std::uint16_t> tcp_links::port() const {
  return listener_ ? std::optional(listener_->port()) : std::nullopt;
}

bool tcp_links::is_listed(const ipv4_address& x) const {
  return config_.networks.empty() ||
         std::ranges::any_of(config_.networks, [&x](const auto& each) { return each.contains(x); });
}

void tcp_links::on_connection(io::tcp_stream x, const ipv4_address& from) {
  if (!is_listed(from))
    ++counters_.foreign; // dropped
  else if (streams_.size() >= streams_max)
    ++counters_.refused; // dropped
  else
    add(std::move(x), peis::link_role::acceptor, std::nullopt);
}

void tcp_links::add(io::tcp_stream x, peis::link_role role,
                    std::optional<peis::attempt_id> attempt) {
  const peis::link_id link{next_link_++};
  auto& stream = streams_[link] = std::move(x);
  stream.start({[this, link](byte_view octets) { user_->on_link_octets(link, octets); },
                [this, link](std::size_t octets) { user_->on_link_sent(link, octets); },
                [this, link](const std::string& why) {
                  streams_.erase(link);
                  user_->on_link_closed(link, why);
                }});
  user_->on_link_open(link, role, attempt);
}

void tcp_links::carry_out(peis::to_link x) {
  const auto found = streams_.find(x.link);
  if (found != streams_.end())
    found->second.send(std::move(x.octets));
  else if (udp_)
    udp_->send(x.link, std::move(x.octets));
}

void tcp_links::carry_out(const peis::close_link& x) {
  if (udp_)
    udp_->close(x);
  auto found = streams_.extract(x.link);
  if (found.empty() || x.why == peis::close_cause::handshake_silent) // no exit is sent
    return;                                                          // to a side that sent nothing
  if (x.why == peis::close_cause::silent || x.why == peis::close_cause::replaced)
    found.mapped().reset(); // what waits to leave would keep it for minutes, at both ends
  else
    close(std::move(found.mapped()));
}

void tcp_links::carry_out(const peis::read_link& x) {
  const auto found = streams_.find(x.link);
  if (found != streams_.end())
    found->second.read(x.wanted);
  else if (udp_)
    udp_->read(x);
}

void tcp_links::carry_out(const peis::pace_link& x) {
  const auto found = streams_.find(x.link);
  if (found != streams_.end())
    found->second.pace();
}

void tcp_links::close(io::tcp_stream x) {
  if (*closing_ >= closing_max)
    return; // dropped
  ++*closing_;
  x.close([closing = closing_] { --*closing; });
}

void tcp_links::carry_out(const peis::connect_to& x) {
  if (over_)
    return;
  using scheme = peis::link_url::scheme;
  const auto url = peis::parse_link_url(x.url);
  const bool over_udp = url && url->medium == scheme::udp;
  if (over_udp && !udp_) {
    fail_soon(x.attempt, x.url + ": links over UDP are disabled");
  } else if (!url || (url->medium != scheme::tcp && !over_udp)) {
    fail_soon(x.attempt, x.url + ": not an address of TCP or UDP");
  } else if ((over_udp ? udp_->attempts() : attempts_.size()) >= attempts_max) {
    ++counters_.too_many;
    fail_soon(x.attempt, x.url + ": too many simultaneous attempts");
  } else if (over_udp) {
    udp_->connect(x.attempt, *url);
  } else {
    const auto attempt = x.attempt;
    attempts_.emplace(
        attempt, io::tcp_connect(*loop_, url->host, url->port, config_.connect_timeout,
                                 [this, attempt](auto y) { on_attempt(attempt, std::move(y)); }));
  }
}

void tcp_links::on_attempt(peis::attempt_id attempt, std::variant<io::tcp_stream, std::string> x) {
  const auto ended = attempts_.extract(attempt); // lives until this call is over
  if (auto* why = std::get_if<std::string>(&x))
    user_->on_attempt_failed(attempt, *why);
  else
    add(std::move(std::get<io::tcp_stream>(x)), peis::link_role::initiator, attempt);
}

void tcp_links::fail_soon(peis::attempt_id attempt, std::string why) {
  loop_->post([this, attempt, why = std::move(why), alive = std::weak_ptr(alive_)] {
    if (!alive.expired() && !over_)
      user_->on_attempt_failed(attempt, why);
  });
}

void tcp_links::carry_out(const peis::announce& x) {
  if (group_)
    group_->send(x.octets.view());
}

void tcp_links::close_all() {
  over_ = true;
  listener_.reset();
  group_.reset();
  attempts_.clear();
  for (auto& [link, x] : streams_)
    close(std::move(x));
  streams_.clear();
  if (udp_)
    udp_->close_all();
}

std::size_t tcp_links::open_links() const {
  return streams_.size() + (udp_ ? udp_->open_links() : 0);
}

std::size_t tcp_links::closing_links() const {
  return *closing_ + (udp_ ? udp_->closing_links() : 0);
}

std::size_t tcp_links::unsent() const {
  std::size_t sum = udp_ ? udp_->unsent() : 0;
  for (const auto& [link, x] : streams_)
    sum += x.unsent();
  return sum;
}

links_counters tcp_links::counters() const {
  auto all = counters_;
  all.unsent = group_ ? group_->unsent() : 0;
  return all;
}

} // namespace rubicon::peer
