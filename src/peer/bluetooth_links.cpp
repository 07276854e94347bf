#include "peer/bluetooth_links.hpp"

#include <algorithm>
#include <utility>

#include "peis/bluetooth/hci_inquiry.hpp"
#include "peis/link/link.hpp"
#include "peis/media/simulated_bluetooth.hpp"
#include "peis/wire/announcement.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peer {

namespace {

constexpr std::size_t ports_max = 16;   ///< peers that share an adapter
constexpr duration inquiry_margin = 5s; ///< an inquiry that has not ended then has failed

/// A package, or what comes before the first one.
std::size_t size_of_first(byte_view octets) {
  const auto header = peis::decode_header(octets);
  const auto size = header ? peis::header_size + header->length : peis::connect_request_size;
  return std::min(size, octets.size());
}

void ignore_sent(std::size_t /*octets*/) {}

} // namespace

bluetooth_links::bluetooth_links(io::loop& where, bluetooth_links_config config,
                                 std::unique_ptr<io::bluetooth_adapter> adapter, link_user& user,
                                 adapter_user& watcher)
    : loop_(&where), config_(std::move(config)), adapter_(std::move(adapter)), user_(&user),
      watcher_(&watcher), inquiry_end_(where), next_link_(config_.first_link.value) {}

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
  auto x = adapter_->listen(peis::hello_port);
  if (auto* socket = std::get_if<io::descriptor>(&x)) // else another peer announces (BT-03)
    hello_listener_.emplace(*loop_, std::move(*socket),
                            [this](io::descriptor y) { on_asker(std::move(y)); });
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

// HELLOs.

void bluetooth_links::on_asker(io::descriptor x) {
  if (arrived_.size() >= hellos_max) {
    ++counters_.hellos_lost; // dropped
    return;
  }
  const auto number = next_hello_++;
  auto& hello = arrived_.try_emplace(number, *loop_).first->second;
  hello.stream = io::packet_stream(*loop_, std::move(x), room);
  hello.stream.start({[this, number](byte_view octets) { on_question(number, octets); },
                      ignore_sent, [this, number](const std::string&) { arrived_.erase(number); }});
  hello.patience.start(config_.hello_timeout, [this, number] { arrived_.erase(number); });
}

void bluetooth_links::on_question(std::uint64_t number, byte_view octets) {
  auto& hello = arrived_.at(number);
  if (!peis::decode_announcement(octets))
    arrived_.erase(number); // dropped
  else if (!std::exchange(hello.taken, true))
    watcher_->on_hello(number, octets);
}

/// The other side closes the connection when it has the answer.
void bluetooth_links::answer_hello(std::uint64_t number, bytes octets) {
  const auto found = arrived_.find(number);
  if (found != arrived_.end())
    static_cast<void>(found->second.stream.send(std::move(octets))); // its queue is empty
}

void bluetooth_links::carry_out(const peis::say_hello& x) {
  if (over_ || sent_.contains(x.to))
    return;
  auto& hello = sent_.try_emplace(x.to, *loop_).first->second;
  const auto give_up = [this, to = x.to] { end_hello(to, {}); };
  hello.patience.start(config_.connect_timeout + config_.hello_timeout, give_up);
  if (sent_.size() > hellos_max) {
    ++counters_.hellos_lost;
    hello.patience.start(0s, give_up);
    return;
  }
  auto socket = adapter_->connect(x.to.octets, peis::hello_port);
  if (!std::holds_alternative<io::descriptor>(socket)) {
    hello.patience.start(0s, give_up);
    return;
  }
  hello.attempt.emplace(*loop_, std::move(std::get<io::descriptor>(socket)),
                        config_.connect_timeout,
                        [this, to = x.to, octets = to_bytes(x.octets.view())](auto y) {
                          if (auto* connected = std::get_if<io::descriptor>(&y))
                            say(to, octets, std::move(*connected));
                          else
                            end_hello(to, {});
                        });
}

void bluetooth_links::say(const peis::bluetooth_address& to, const bytes& octets,
                          io::descriptor connected) {
  auto& stream = sent_.at(to).stream;
  stream = io::packet_stream(*loop_, std::move(connected), room);
  stream.start({[this, to](byte_view answer) { end_hello(to, answer); }, ignore_sent,
                [this, to](const std::string&) { end_hello(to, {}); }});
  static_cast<void>(stream.send(octets)); // its queue is empty
}

void bluetooth_links::end_hello(const peis::bluetooth_address& to, byte_view answer) {
  const auto ended = sent_.extract(to); // lives until this call is over
  watcher_->on_hello_answer(config_.adapter, to, answer);
}

// Scans.

void bluetooth_links::carry_out(const peis::scan_adapter& x) {
  if (over_ || scanning_ || x.adapter != config_.adapter)
    return;
  auto socket = adapter_->open_controller();
  if (!std::holds_alternative<io::descriptor>(socket)) {
    ++counters_.scans_failed;
    return;
  }
  scanning_ = true;
  seen_.clear();
  controller_ = io::packet_stream(*loop_, std::move(std::get<io::descriptor>(socket)), room);
  controller_.start({[this](byte_view packet) { on_inquiry(packet); }, ignore_sent,
                     [this](const std::string&) { end_scan(false); }});
  static_cast<void>(controller_.send(peis::inquiry_command(config_.inquiry))); // its queue is empty
  inquiry_end_.start(config_.inquiry + inquiry_margin, [this] { end_scan(false); });
}

void bluetooth_links::on_inquiry(byte_view packet) {
  const auto event = peis::decode_inquiry_event(packet);
  if (const auto* ended = std::get_if<peis::inquiry_ended>(&event)) {
    end_scan(ended->success);
    return;
  }
  for (const auto& each : std::get<std::vector<peis::seen_device>>(event)) {
    if (seen_.contains(each.address) || seen_.size() < seen_max)
      seen_[each.address] = each.strength_dbm;
  }
}

void bluetooth_links::end_scan(bool success) {
  if (!std::exchange(scanning_, false))
    return;
  inquiry_end_.stop();
  controller_ = {};
  std::vector<peis::seen_device> found;
  for (const auto& [address, strength_dbm] : std::exchange(seen_, {}))
    found.push_back({address, strength_dbm});
  if (success)
    watcher_->on_scan(config_.adapter, found);
  else
    ++counters_.scans_failed;
}

void bluetooth_links::close_all() {
  over_ = true;
  listener_.reset();
  hello_listener_.reset();
  attempts_.clear();
  arrived_.clear();
  sent_.clear();
  scanning_ = false;
  inquiry_end_.stop();
  controller_ = {};
  for (auto& [link, x] : streams_) {
    if (*closing_ >= closing_max)
      continue; // dropped
    ++*closing_;
    x.close([closing = closing_] { --*closing; });
  }
  streams_.clear();
}

} // namespace rubicon::peer
