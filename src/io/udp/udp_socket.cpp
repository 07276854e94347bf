#include "io/udp/udp_socket.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <deque>
#include <utility>

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <boost/asio/error.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "core/time.hpp"
#include "io/context.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

namespace {

// Of <linux/udp.h>, since Linux 4.18 and 5.0.
constexpr int option_segment = 103;
constexpr int option_receive_many = 104;

constexpr int system_buffer = 4 * 1024 * 1024; ///< wanted; net.core.rmem_max and wmem_max limit it
constexpr int reads_of_a_turn = 16;

sockaddr_in address_of(const ipv4_address& to, std::uint16_t port) {
  sockaddr_in x{};
  x.sin_family = AF_INET;
  x.sin_port = htons(port);
  std::memcpy(&x.sin_addr, to.data(), to.size());
  return x;
}

template <class Value>
void put_control(msghdr& into, int type, Value value) {
  auto* head = CMSG_FIRSTHDR(&into);
  head->cmsg_level = IPPROTO_UDP;
  head->cmsg_type = type;
  head->cmsg_len = CMSG_LEN(sizeof value);
  std::memcpy(CMSG_DATA(head), &value, sizeof value);
}

/// How long each of the datagrams is that came together; 0: it is one.
std::size_t size_of_each(msghdr& x) {
  for (auto* head = CMSG_FIRSTHDR(&x); head != nullptr; head = CMSG_NXTHDR(&x, head)) {
    if (head->cmsg_level != IPPROTO_UDP || head->cmsg_type != option_receive_many)
      continue;
    int size = 0;
    std::memcpy(&size, CMSG_DATA(head), sizeof size);
    return static_cast<std::size_t>(std::max(size, 0));
  }
  return 0;
}

} // namespace

struct udp_socket::state : std::enable_shared_from_this<state> {
  struct batch {
    bytes octets;
    std::size_t each = 0;
    sockaddr_in to{};
    std::size_t gone = 0;
  };

  state(loop& where, callbacks x)
      : socket(context_of(where)), pause(context_of(where)), to_owner(std::move(x)) {}

  udp::socket socket;
  asio::steady_timer pause;
  callbacks to_owner;
  bytes input = bytes(std::size_t{64} * 1024);
  std::deque<batch> waiting;
  std::size_t waiting_octets = 0;
  std::uint64_t unsent = 0;
  bool sends_many = true;
  bool over = false;

  error_code bind(const udp::endpoint& at) {
    error_code error;
    socket.open(udp::v4(), error);
    if (!error)
      socket.bind(at, error);
    if (!error)
      socket.non_blocking(true, error);
    if (error) {
      error_code ignored;
      socket.close(ignored);
      return error;
    }
    error_code ignored; // it works without
    socket.set_option(asio::socket_base::receive_buffer_size(system_buffer), ignored);
    socket.set_option(asio::socket_base::send_buffer_size(system_buffer), ignored);
    const int on = 1;
    static_cast<void>(
        ::setsockopt(socket.native_handle(), IPPROTO_UDP, option_receive_many, &on, sizeof on));
    return error;
  }

  void receive() {
    socket.async_wait(udp::socket::wait_read, [x = shared_from_this()](const error_code& error) {
      if (x->over)
        return;
      if (error)
        x->receive_later();
      else
        x->take_all();
    });
  }

  void receive_later() {
    pause.expires_after(pause_after_error);
    pause.async_wait([x = shared_from_this()](const error_code&) {
      if (!x->over)
        x->receive();
    });
  }

  void take_all() {
    int taken = 0;
    while (taken < reads_of_a_turn && !over && take_some())
      ++taken;
    if (!over && taken > 0)
      to_owner.on_turn();
    if (!over)
      receive();
  }

  /// @returns whether there was anything; an error of the network about what was sent is nothing
  bool take_some() {
    sockaddr_in from{};
    iovec piece{input.data(), input.size()};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
    msghdr x{};
    x.msg_name = &from;
    x.msg_namelen = sizeof from;
    x.msg_iov = &piece;
    x.msg_iovlen = 1;
    x.msg_control = control.data();
    x.msg_controllen = control.size();
    const auto size = ::recvmsg(socket.native_handle(), &x, MSG_DONTWAIT);
    if (size < 0)
      return false;
    const byte_view octets(input.data(), static_cast<std::size_t>(size));
    const auto each = size_of_each(x);
    ipv4_address address{};
    std::memcpy(address.data(), &from.sin_addr, address.size());
    to_owner.on_datagrams(octets, each == 0 ? octets.size() : each, address, ntohs(from.sin_port));
    return true;
  }

  void send(batch x) {
    if (waiting.empty() && write(x))
      return;
    const auto rest = x.octets.size() - x.gone;
    if (waiting_octets + rest > waiting_max) {
      unsent += (rest + x.each - 1) / x.each;
      return;
    }
    waiting_octets += rest;
    waiting.push_back(std::move(x));
    if (waiting.size() == 1)
      write_later();
  }

  void write_later() {
    socket.async_wait(udp::socket::wait_write, [x = shared_from_this()](const error_code& error) {
      if (x->over)
        return;
      while (!error && !x->waiting.empty() && x->write(x->waiting.front())) {
        const auto& done = x->waiting.front();
        x->waiting_octets -= std::min(x->waiting_octets, done.octets.size());
        x->waiting.pop_front();
      }
      if (x->waiting.empty())
        x->waiting_octets = 0;
      else
        x->write_later();
    });
  }

  /// @returns false if the system has no room now; x.gone is how much it has taken
  bool write(batch& x) {
    while (x.gone < x.octets.size()) {
      const auto rest = x.octets.size() - x.gone;
      const auto size = sends_many ? rest : std::min(rest, x.each);
      if (write_some(x, size) >= 0) {
        x.gone += size;
      } else if (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS) {
        return false;
      } else if (sends_many && rest > x.each && (errno == EINVAL || errno == EIO)) {
        sends_many = false; // this system or its network card cannot
      } else {
        unsent += (size + x.each - 1) / x.each;
        x.gone += size;
      }
    }
    return true;
  }

  ssize_t write_some(batch& x, std::size_t size) {
    iovec piece{x.octets.data() + x.gone, size};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(std::uint16_t))> control{};
    msghdr message{};
    message.msg_name = &x.to;
    message.msg_namelen = sizeof x.to;
    message.msg_iov = &piece;
    message.msg_iovlen = 1;
    if (size > x.each) {
      message.msg_control = control.data();
      message.msg_controllen = control.size();
      put_control(message, option_segment, static_cast<std::uint16_t>(x.each));
    }
    return ::sendmsg(socket.native_handle(), &message, MSG_DONTWAIT | MSG_NOSIGNAL);
  }
};

udp_socket::udp_socket(std::shared_ptr<state> x) : state_(std::move(x)) {}

std::variant<udp_socket, std::string> udp_socket::open(loop& where, const std::string& address,
                                                       std::uint16_t first_port,
                                                       callbacks to_owner) {
  assert(to_owner.on_datagrams && to_owner.on_turn);
  const auto refusal = [&](const error_code& error) {
    return "no UDP at " + address + ':' + std::to_string(first_port) + ": " + error.message();
  };
  error_code error;
  const auto parsed = asio::ip::make_address_v4(address, error);
  if (error)
    return refusal(error);
  auto x = std::make_shared<state>(where, std::move(to_owner));
  auto port = first_port;
  error = x->bind({parsed, port});
  while (error == asio::error::address_in_use && port != 0 && port != 0xffff)
    error = x->bind({parsed, ++port});
  if (error)
    return refusal(error);
  x->receive();
  return udp_socket(std::move(x));
}

udp_socket::~udp_socket() {
  if (!state_)
    return;
  state_->over = true;
  error_code ignored;
  state_->socket.close(ignored);
  state_->pause.cancel();
}

udp_socket::udp_socket(udp_socket&&) noexcept = default;

udp_socket& udp_socket::operator=(udp_socket&& other) noexcept {
  const udp_socket replaced(std::exchange(state_, std::exchange(other.state_, nullptr)));
  return *this;
}

std::uint16_t udp_socket::port() const {
  error_code ignored;
  return state_->socket.local_endpoint(ignored).port();
}

std::size_t udp_socket::input_octets() const {
  asio::socket_base::receive_buffer_size size;
  error_code ignored;
  state_->socket.get_option(size, ignored);
  return static_cast<std::size_t>(std::max(size.value(), 0));
}

void udp_socket::send(bytes datagrams, std::size_t each, const ipv4_address& to,
                      std::uint16_t port) {
  assert(each > 0 && datagrams.size() <= batch_octets_max);
  state_->send({std::move(datagrams), each, address_of(to, port), 0});
}

std::uint64_t udp_socket::unsent() const {
  return state_->unsent;
}

} // namespace rubicon::io
