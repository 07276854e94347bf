#include "io/udp_group.hpp"

#include <array>
#include <chrono>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/ip/multicast.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "io/context.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
namespace multicast = asio::ip::multicast;
using asio::ip::address_v4;
using asio::ip::udp;
using boost::system::error_code;

namespace {

constexpr auto pause_after_error = std::chrono::milliseconds(100);

} // namespace

struct udp_group::state : std::enable_shared_from_this<state> {
  state(loop& where, callback f)
      : receiver(context_of(where)), sender(context_of(where)), pause(context_of(where)),
        on_datagram(std::move(f)) {}

  udp::socket receiver;
  udp::socket sender; ///< another one: its port is ephemeral, as that of real kernels
  asio::steady_timer pause;
  udp::endpoint group;
  callback on_datagram;
  std::array<std::uint8_t, datagram_max> input{};
  std::uint64_t unsent = 0;
  bool over = false;

  error_code open(const udp_group_config& config) {
    error_code error;
    const auto address = asio::ip::make_address_v4(config.group, error);
    if (error)
      return error;
    if (!address.is_multicast())
      return asio::error::invalid_argument;
    auto own = address_v4::any();
    if (!config.interface.empty())
      own = asio::ip::make_address_v4(config.interface, error);
    if (error)
      return error;
    group = {address, config.port};
    error = open_receiver(own);
    return error ? error : open_sender(own, config.hops_max);
  }

  error_code open_receiver(address_v4 own) {
    error_code error;
    receiver.open(udp::v4(), error);
    if (!error)
      receiver.set_option(udp::socket::reuse_address(true), error);
    if (!error) // to the group's address: datagrams of other groups and for us alone stay out
      receiver.bind(group, error);
    if (!error)
      receiver.set_option(multicast::join_group(group.address().to_v4(), own), error);
    return error;
  }

  error_code open_sender(address_v4 own, int hops_max) {
    error_code error;
    sender.open(udp::v4(), error);
    if (!error)
      sender.set_option(multicast::hops(hops_max), error);
    if (!error)
      sender.set_option(multicast::enable_loopback(true), error);
    if (!error && own != address_v4::any())
      sender.set_option(multicast::outbound_interface(own), error);
    if (!error)
      sender.non_blocking(true, error);
    return error;
  }

  void receive() {
    receiver.async_receive(asio::buffer(input),
                           [x = shared_from_this()](const error_code& error, std::size_t size) {
                             x->on_received(error, size);
                           });
  }

  void on_received(const error_code& error, std::size_t size) {
    if (over)
      return;
    if (!error) {
      on_datagram(byte_view(input).first(size));
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
};

udp_group::udp_group(std::shared_ptr<state> x) : state_(std::move(x)) {}

std::variant<udp_group, std::string> udp_group::join(loop& where, const udp_group_config& config,
                                                     callback on_datagram) {
  auto x = std::make_shared<state>(where, std::move(on_datagram));
  if (const auto error = x->open(config))
    return config.group + ':' + std::to_string(config.port) + ": " + error.message();
  x->receive();
  return udp_group(std::move(x));
}

udp_group::~udp_group() {
  if (!state_)
    return;
  state_->over = true;
  error_code ignored;
  state_->receiver.close(ignored);
  state_->sender.close(ignored);
  state_->pause.cancel();
}

udp_group::udp_group(udp_group&&) noexcept = default;

udp_group& udp_group::operator=(udp_group&& other) noexcept {
  const udp_group replaced(std::exchange(state_, std::exchange(other.state_, nullptr)));
  return *this;
}

void udp_group::send(byte_view datagram) {
  error_code error;
  state_->sender.send_to(asio::buffer(datagram.data(), datagram.size()), state_->group, 0, error);
  if (error)
    ++state_->unsent;
}

std::uint64_t udp_group::unsent() const {
  return state_->unsent;
}

} // namespace rubicon::io
