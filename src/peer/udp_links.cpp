#include "peer/udp_links.hpp"

#include <algorithm>
#include <random>
#include <utility>

namespace rubicon::peer {

namespace {

/// What a full datagram takes of a socket's buffer (struct sk_buff included).
constexpr std::size_t octets_in_system = 2304;
/// Acknowledged before the kernel looks at it, whose answer otherwise carries that along.
constexpr std::size_t much_at_a_time = 8 * peis::udp_datagram_max;

peis::udp_secret secret_of_system() {
  std::random_device device;
  const auto word = [&device] { return static_cast<std::uint64_t>(device()) << 32 | device(); };
  return {word(), word()};
}

} // namespace

udp_links::udp_links(io::loop& where, udp_links_config config, link_user& user,
                     std::function<peis::link_id()> next_link)
    : loop_(&where), config_(std::move(config)), user_(&user), next_link_(std::move(next_link)),
      timer_(where) {}

std::variant<std::unique_ptr<udp_links>, std::string>
udp_links::open(io::loop& where, udp_links_config config, link_user& user,
                std::function<peis::link_id()> next_link) {
  std::unique_ptr<udp_links> x(new udp_links(where, std::move(config), user, std::move(next_link)));
  if (auto refusal = x->open_socket())
    return *std::move(refusal);
  return x;
}

std::optional<std::string> udp_links::open_socket() {
  auto opened = io::udp_socket::open(
      *loop_, config_.address, config_.first_port.value_or(0),
      {[this](byte_view datagrams, std::size_t each, const ipv4_address& from, std::uint16_t port) {
         on_datagrams(datagrams, each, {from, port});
       },
       [this] { process(); }});
  if (auto* refusal = std::get_if<std::string>(&opened))
    return std::move(*refusal);
  socket_ = std::move(std::get<io::udp_socket>(opened));
  peis::udp_port_config x;
  x.accepts = config_.first_port.has_value();
  x.networks = config_.networks;
  x.room = static_cast<std::uint16_t>(
      std::min<std::size_t>(UINT16_MAX, socket_->input_octets() / octets_in_system));
  port_ = peis::udp_port(x, secret_of_system());
  return std::nullopt;
}

udp_links::~udp_links() {
  for (const auto& [link, token] : tokens_)
    port_.reset(token);
  send_due();
}

void udp_links::send(peis::link_id link, payload octets) {
  const auto found = tokens_.find(link);
  if (found == tokens_.end())
    return;
  port_.send(found->second, std::move(octets));
  process_soon();
}

void udp_links::read(const peis::read_link& x) {
  const auto found = tokens_.find(x.link);
  if (found == tokens_.end())
    return;
  port_.read(found->second, x.wanted);
  if (x.wanted)
    process_soon();
}

void udp_links::close(const peis::close_link& x) {
  const auto found = tokens_.extract(x.link);
  if (found.empty())
    return;
  links_.erase(found.mapped());
  using cause = peis::close_cause;
  if (x.why == cause::handshake_silent || x.why == cause::silent || x.why == cause::replaced)
    port_.reset(found.mapped());
  else
    port_.close(found.mapped(), now());
  process_soon();
}

void udp_links::close_all() {
  over_ = true;
  lookups_.clear();
  for (const auto& [link, token] : tokens_)
    port_.close(token, now());
  tokens_.clear();
  links_.clear();
  process_soon();
}

void udp_links::connect(peis::attempt_id attempt, const peis::link_url& to) {
  targets_[attempt] = to_string(to);
  lookups_.emplace(attempt,
                   io::host_lookup(*loop_, to.host, [this, attempt, port = to.port](auto found) {
                     on_address(attempt, port, found);
                   }));
}

void udp_links::on_address(peis::attempt_id attempt, std::uint16_t port,
                           const std::variant<ipv4_address, std::string>& found) {
  const auto ended = lookups_.extract(attempt); // lives until this call is over
  if (const auto* why = std::get_if<std::string>(&found)) {
    targets_.erase(attempt);
    user_->on_attempt_failed(attempt, *why);
    return;
  }
  port_.connect(attempt, {std::get<ipv4_address>(found), port}, config_.connect_timeout, now());
  process();
}

void udp_links::on_datagrams(byte_view datagrams, std::size_t each, const peis::udp_address& from) {
  const auto at = now();
  const bool much = datagrams.size() >= much_at_a_time;
  if (datagrams.empty())
    port_.on_datagram(from, datagrams, at);
  while (!datagrams.empty()) {
    const auto size = std::min(each, datagrams.size());
    port_.on_datagram(from, datagrams.first(size), at);
    datagrams = datagrams.subspan(size);
  }
  if (!much)
    return;
  send_due(); // so that more comes while this is worked off
  process();
}

/// What is sent in one turn leaves together.
void udp_links::process_soon() {
  if (std::exchange(process_due_, true))
    return;
  loop_->post([this, alive = std::weak_ptr(alive_)] {
    if (!alive.expired() && process_due_)
      process();
  });
}

void udp_links::process() {
  if (const auto due = port_.deadline(); due && *due <= now())
    port_.on_time(now());
  for (auto& event : port_.take_events()) {
    std::visit([this](const auto& x) { this->handle(x); }, event);
    if (auto* received = std::get_if<peis::udp_received>(&event))
      port_.give_back(std::move(received->octets));
  }
  process_due_ = false; // what was sent just now leaves now
  send_due();
  const auto due = port_.deadline();
  if (!due || (wakes_at_ && *wakes_at_ <= *due && *wakes_at_ > now()))
    return;
  wakes_at_ = due;
  timer_.start(std::max<duration>(*due - now(), 0ns), [this] {
    wakes_at_.reset();
    process();
  });
}

void udp_links::send_due() {
  for (auto& x : port_.flush(now()))
    socket_->send(std::move(x.octets), x.each, x.to.ip, x.to.port);
}

void udp_links::handle(const peis::udp_opened& x) {
  const auto link = next_link_();
  if (x.attempt)
    targets_.erase(*x.attempt);
  if (over_) {
    port_.reset(x.session);
    return;
  }
  tokens_[link] = x.session;
  links_[x.session] = link;
  user_->on_link_open(link, x.attempt ? peis::link_role::initiator : peis::link_role::acceptor,
                      x.attempt);
}

void udp_links::handle(const peis::udp_refused& x) {
  const auto target = targets_.extract(x.attempt);
  if (!over_ && !target.empty())
    user_->on_attempt_failed(x.attempt, target.mapped() + ": " + std::string(x.why));
}

void udp_links::handle(const peis::udp_received& x) {
  const auto found = links_.find(x.session);
  if (found != links_.end())
    user_->on_link_octets(found->second, x.octets);
}

void udp_links::handle(const peis::udp_acknowledged& x) {
  const auto found = links_.find(x.session);
  if (found != links_.end())
    user_->on_link_sent(found->second, x.octets);
}

void udp_links::handle(const peis::udp_closed& x) {
  const auto found = links_.extract(x.session);
  if (found.empty())
    return;
  tokens_.erase(found.mapped());
  user_->on_link_closed(found.mapped(), std::string(x.why));
}

peis::udp_counters udp_links::counters() const {
  auto x = port_.counters();
  x.unsent = socket_->unsent();
  return x;
}

} // namespace rubicon::peer
