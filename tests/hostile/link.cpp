#include "hostile/link.hpp"

#include <algorithm>
#include <array>
#include <cerrno>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/codec.hpp"
#include "peis/wire/acknowledgement.hpp"
#include "peis/wire/heartbeat.hpp"
#include "peis/wire/routing_page.hpp"

namespace rubicon::hostile {

namespace {

constexpr std::int32_t first_id = 1000;
constexpr std::uint8_t filler = 'x';

} // namespace

link::link(const target& whom, std::size_t index, random_stream rng)
    : id(first_id + static_cast<std::int32_t>(index)), host_name("stranger"), whom_(whom),
      index_(index), rng_(rng) {
  magic = number();
}

link::~link() {
  if (descriptor_ >= 0)
    ::close(descriptor_);
}

std::int32_t link::number() {
  return static_cast<std::int32_t>(1 + rng_.below(0x7ffffffe));
}

void link::connect(int receive_buffer) {
  descriptor_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor_ < 0)
    return;
  if (receive_buffer > 0)
    ::setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
  const int on = 1;
  ::setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(whom_.port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK); // and nobody else, ever
  if (::connect(descriptor_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0 &&
      errno != EINPROGRESS)
    cut();
}

void link::drop(bool reset) {
  if (descriptor_ < 0)
    return;
  const linger how{reset ? 1 : 0, 0};
  ::setsockopt(descriptor_, SOL_SOCKET, SO_LINGER, &how, sizeof how);
  ::close(descriptor_);
  descriptor_ = -1;
  open_ = false;
  out_.clear();
  written_ = 0;
  decoder_ = {};
  counter_ = 0;
  fragments_ = next_fragment_ = 0;
  said_since_open = 0;
}

void link::cut() {
  ++counts_.cut;
  drop(false);
}

short link::events(bool reads) const {
  if (!open_)
    return POLLOUT;
  return static_cast<short>((reads ? POLLIN : 0) | (waiting() > 0 ? POLLOUT : 0));
}

void link::on_events(short events, bool reads, const listener& hear) {
  if (!open_ && (events & (POLLOUT | POLLERR | POLLHUP)) != 0) {
    int error = 0;
    socklen_t size = sizeof error;
    ::getsockopt(descriptor_, SOL_SOCKET, SO_ERROR, &error, &size);
    if (error != 0)
      return cut();
    open_ = true;
    ++counts_.opened;
    return;
  }
  if ((events & POLLOUT) != 0)
    write();
  if (descriptor_ >= 0 && reads && (events & (POLLIN | POLLHUP | POLLERR)) != 0)
    read(hear);
  else if (descriptor_ >= 0 && (events & (POLLHUP | POLLERR)) != 0)
    cut();
}

void link::write() {
  while (waiting() > 0) {
    const auto n = ::send(descriptor_, out_.data() + written_, waiting(), MSG_NOSIGNAL);
    if (n < 0 && (errno == EAGAIN || errno == EINTR))
      return;
    if (n < 0)
      return cut();
    written_ += static_cast<std::size_t>(n);
    counts_.octets += static_cast<std::uint64_t>(n);
  }
  out_.clear();
  written_ = 0;
}

void link::read(const listener& hear) {
  std::array<std::uint8_t, 65536> block; // NOLINT: filled by recv
  const auto n = ::recv(descriptor_, block.data(), block.size(), 0);
  if (n < 0 && (errno == EAGAIN || errno == EINTR))
    return;
  if (n <= 0)
    return cut();
  decoder_.feed(byte_view(block).first(static_cast<std::size_t>(n)));
  while (const auto x = decoder_.next()) {
    ++counts_.heard;
    hear(*x);
  }
}

void link::say_octets(byte_view octets) {
  out_.insert(out_.end(), octets.begin(), octets.end());
}

void link::say_as(const peis::package_header& header, byte_view data) {
  peis::encode(header, out_);
  say_octets(data);
  ++counts_.packages;
  ++said_since_open;
}

void link::say(const draft& x, byte_view data) {
  say_as(header_of(x, data.size()), data);
}

peis::package_header link::header_of(const draft& x, std::size_t length) {
  peis::package_header header;
  header.id = header.ack_id = number();
  if (x.reliable) {
    header.flags = peis::package_flag::reliable;
    header.ack_id = number();
  }
  header.counter = counter_++;
  header.type = x.type;
  header.source = x.source.value_or(id);
  header.destination = x.destination;
  header.port = x.port;
  header.length = static_cast<std::uint16_t>(length);
  return header;
}

void link::begin(const draft& x, bytes message, std::size_t filling) {
  message_size_ = message.size() + filling;
  if (message_size_ <= peis::data_max) {
    message.resize(message_size_, filler);
    return say(x, message);
  }
  long_ = x;
  message_ = std::move(message);
  fragments_ = (message_size_ + peis::data_max - 1) / peis::data_max;
  next_fragment_ = 0;
  group_ = static_cast<std::uint16_t>(1 + rng_.below(32767));
}

void link::say_fragment() {
  const auto at = std::min(next_fragment_ * peis::data_max, message_.size());
  auto data = to_bytes(byte_view(message_).subspan(at));
  data.resize(std::min(peis::data_max, message_size_ - next_fragment_ * peis::data_max), filler);
  auto header = header_of(long_, data.size());
  header.flags |= peis::package_flag::bulk;
  header.seqlen = static_cast<std::uint16_t>(fragments_);
  header.seqid = group_;
  header.seqnum = static_cast<std::uint16_t>(next_fragment_++);
  say_as(header, data);
}

void link::request(std::uint32_t flags) {
  say_octets(peis::encode(peis::connect_request{peis::protocol_version, id, flags, whom_.network}));
}

peis::host_record link::record() const {
  peis::host_record x;
  x.id = id;
  x.magic = magic;
  x.host_name = host_name;
  x.full_name = "stranger@" + host_name + "!1";
  x.cluster = id.value;
  x.marked = marked;
  return x;
}

void link::introduce() {
  say({.type = peis::package_type::link, .port = peis::port::host_record},
      peis::encode(peis::host_record_message{record(), false}));
  peis::routing_page page;
  page.seqno = next_seqno();
  page.entries.push_back({id, page.seqno, magic, 0, 1});
  say({.type = peis::package_type::link, .port = peis::port::routing}, peis::encode(page));
}

void link::greet(std::uint32_t flags) {
  request(flags);
  introduce();
}

void link::beat() {
  const instant sometime{1s * seqno_++};
  say({.type = peis::package_type::link, .port = peis::port::heartbeat},
      peis::encode(peis::heartbeat{sometime, instant{}, 0s}));
}

void link::acknowledge(const peis::received_package& x) {
  if (!x.header.reliable() || x.header.destination != id)
    return;
  const std::array ids{x.header.ack_id};
  say({.port = peis::port::acknowledgements, .destination = x.header.source},
      peis::encode_acknowledgement(ids));
}

} // namespace rubicon::hostile
