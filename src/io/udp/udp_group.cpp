#include "io/udp/udp_group.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/ip/multicast.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "io/context.hpp"
#include "io/process/machine.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
namespace multicast = asio::ip::multicast;
using asio::ip::address_v4;
using asio::ip::udp;
using boost::system::error_code;

struct udp_group::state : std::enable_shared_from_this<state> {
  state(loop& where, udp_group_config with, callback f)
      : where_loop(where), config(std::move(with)), receiver(context_of(where)),
        pause(context_of(where)), next_look(context_of(where)), on_datagram(std::move(f)) {}

  loop& where_loop;
  const udp_group_config config;
  udp::socket receiver;
  /// By own address, one of each device: others than the receiver, since their ports are ephemeral
  /// as those of real kernels.
  std::map<address_v4, udp::socket> senders;
  asio::steady_timer pause;
  asio::steady_timer next_look;
  udp::endpoint group;
  callback on_datagram;
  std::function<void()> on_change;
  std::vector<network_interface> seen;
  std::array<std::uint8_t, datagram_max> input{};
  udp::endpoint from; ///< of what is in it
  std::uint64_t unsent = 0;
  error_code refused = asio::error::network_down; ///< while there is no sender: why
  bool over = false;

  error_code open() {
    error_code error;
    const auto address = asio::ip::make_address_v4(config.group, error);
    if (error)
      return error;
    if (!address.is_multicast())
      return asio::error::invalid_argument;
    for (const auto& each : config.interfaces) {
      static_cast<void>(asio::ip::make_address_v4(each, error));
      if (error)
        return error;
    }
    group = {address, config.port};
    receiver.open(udp::v4(), error);
    if (!error)
      receiver.set_option(udp::socket::reuse_address(true), error);
    if (!error) // to the group's address: datagrams of other groups and for us alone stay out
      receiver.bind(group, error);
    return error;
  }

  [[nodiscard]] bool is_wanted(const network_interface& x) const {
    if (config.interfaces.empty())
      return !x.loopback;
    return std::ranges::find(config.interfaces, address_v4(x.ipv4).to_string()) !=
           config.interfaces.end();
  }

  /// Joins over what has come, leaves what has gone.
  void look() {
    auto now = network_interfaces();
    std::map<std::string, address_v4> wanted; // by device: with several addresses it is one still
    for (const auto& each : now)
      if (is_wanted(each))
        wanted.emplace(each.device, address_v4(each.ipv4));
    const auto is_gone = [&wanted](const auto& sender) {
      return std::ranges::none_of(wanted,
                                  [&](const auto& each) { return each.second == sender.first; });
    };
    for (auto x = senders.begin(); x != senders.end();) {
      error_code ignored;
      if (is_gone(*x)) {
        receiver.set_option(multicast::leave_group(group.address().to_v4(), x->first), ignored);
        x = senders.erase(x);
      } else {
        ++x;
      }
    }
    for (const auto& [device, own] : wanted) {
      const auto error = join_over(own);
      if (error)
        refused = error;
    }
    if (std::exchange(seen, now) != now && on_change)
      on_change();
  }

  /// Again for those that are joined: one that went and came between two looks is not any more.
  error_code join_over(address_v4 own) {
    error_code error;
    receiver.set_option(multicast::join_group(group.address().to_v4(), own), error);
    if (error && error != asio::error::address_in_use)
      return error;
    if (senders.contains(own))
      return {};
    udp::socket sender(context_of(where_loop));
    sender.open(udp::v4(), error);
    if (!error)
      sender.set_option(multicast::hops(config.hops_max), error);
    if (!error)
      sender.set_option(multicast::enable_loopback(true), error);
    if (!error)
      sender.set_option(multicast::outbound_interface(own), error);
    if (!error)
      sender.non_blocking(true, error);
    if (!error)
      senders.emplace(own, std::move(sender));
    return error;
  }

  void look_later() {
    next_look.expires_after(config.look_every);
    next_look.async_wait([x = shared_from_this()](const error_code& error) {
      if (error || x->over)
        return;
      x->look();
      if (!x->over)
        x->look_later();
    });
  }

  void receive() {
    receiver.async_receive_from(
        asio::buffer(input), from,
        [x = shared_from_this()](const error_code& error, std::size_t size) {
          x->on_received(error, size);
        });
  }

  void on_received(const error_code& error, std::size_t size) {
    if (over)
      return;
    if (!error) {
      on_datagram(byte_view(input).first(size), from.address().to_v4().to_bytes());
      if (!over)
        receive();
      return;
    }
    pause.expires_after(pause_after_error);
    pause.async_wait([x = shared_from_this()](const error_code&) {
      if (!x->over)
        x->receive();
    });
  }

  void send(byte_view datagram) {
    for (auto& [own, sender] : senders) {
      error_code error;
      sender.send_to(asio::buffer(datagram.data(), datagram.size()), group, 0, error);
      if (error)
        ++unsent;
    }
    if (senders.empty())
      ++unsent;
  }

  [[nodiscard]] std::string text_of(const error_code& x) const {
    return config.group + ':' + std::to_string(config.port) + ": " + x.message();
  }
};

udp_group::udp_group(std::shared_ptr<state> x) : state_(std::move(x)) {}

std::variant<udp_group, std::string> udp_group::join(loop& where, const udp_group_config& config,
                                                     callback on_datagram) {
  auto x = std::make_shared<state>(where, config, std::move(on_datagram));
  if (const auto error = x->open())
    return x->text_of(error);
  x->look();
  x->look_later();
  x->receive();
  return udp_group(std::move(x));
}

udp_group::~udp_group() {
  if (!state_)
    return;
  state_->over = true;
  error_code ignored;
  state_->receiver.close(ignored);
  state_->senders.clear();
  state_->pause.cancel();
  state_->next_look.cancel();
}

udp_group::udp_group(udp_group&&) noexcept = default;

udp_group& udp_group::operator=(udp_group&& other) noexcept {
  const udp_group replaced(std::exchange(state_, std::exchange(other.state_, nullptr)));
  return *this;
}

void udp_group::send(byte_view datagram) {
  state_->send(datagram);
}

void udp_group::on_change(std::function<void()> f) {
  state_->on_change = std::move(f);
}

std::uint64_t udp_group::unsent() const {
  return state_->unsent;
}

std::string udp_group::trouble() const {
  return state_->senders.empty() ? state_->text_of(state_->refused) : std::string();
}

} // namespace rubicon::io
