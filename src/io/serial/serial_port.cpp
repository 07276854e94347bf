#include "io/serial/serial_port.hpp"

#include <cassert>
#include <utility>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <boost/asio/error.hpp>
#include <boost/asio/serial_port.hpp>

#include "io/serial/descriptor_channel.hpp"
#include "io/serial/port_holders.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

/// What there is to do about a port that does not open.
std::string advice(const error_code& error) {
  namespace errc = boost::system::errc;
  if (error == errc::permission_denied)
    return ": permission denied; run `sudo adduser $USER dialout`, then log in again";
  if (error == errc::no_such_file_or_directory || error == errc::no_such_device ||
      error == errc::no_such_device_or_address)
    return ": is the mote plugged in? `rubicon doctor` lists the ports";
  if (error == errc::device_or_resource_busy)
    return ": another program uses it; end that program";
  if (error == errc::inappropriate_io_control_operation)
    return ": it is not a serial port";
  return {};
}

/// The first thing that goes wrong, in words; empty: nothing does.
std::string prepare(asio::serial_port& port, const std::string& path, std::uint32_t baud) {
  using base = asio::serial_port_base;
  error_code error;
  port.open(path, error);
  if (error)
    return path + ": " + error.message() + advice(error);
  port.set_option(base::baud_rate(baud), error);
  if (error)
    return path + ": " + std::to_string(baud) + " baud cannot be set: " + error.message();
  port.set_option(base::character_size(8), error);
  if (!error)
    port.set_option(base::parity(base::parity::none), error);
  if (!error)
    port.set_option(base::stop_bits(base::stop_bits::one), error);
  if (!error)
    port.set_option(base::flow_control(base::flow_control::none), error);
  return error ? path + ": " + error.message() : std::string();
}

} // namespace

std::variant<serial_port, std::string> serial_port::open(loop& where, const std::string& path,
                                                         std::uint32_t baud, std::size_t room) {
  if (const auto holder = holder_of_terminal(path); !holder.empty())
    return path + ": " + holder +
           " uses it, and each would receive only part of the data; end that program";
  asio::serial_port port(context_of(where));
  if (auto why = prepare(port, path, baud); !why.empty())
    return why;
  // Two programs would each get a part of what comes: those that open it later are refused.
  static_cast<void>(::ioctl(port.native_handle(), TIOCEXCL));
  const int own = ::fcntl(port.native_handle(), F_DUPFD_CLOEXEC, 0);
  if (own < 0)
    return path + ": " + error_code(errno, boost::system::system_category()).message();
  return serial_port(std::make_shared<descriptor_channel>(where, own, room));
}

serial_port::serial_port() = default;

serial_port::serial_port(std::shared_ptr<descriptor_channel> x) : channel_(std::move(x)) {}

serial_port::~serial_port() {
  if (!channel_)
    return;
  // A pseudo-terminal outlives those that have it open.
  static_cast<void>(::ioctl(channel_->descriptor(), TIOCNXCL));
  channel_->close();
}

serial_port::serial_port(serial_port&&) noexcept = default;

serial_port& serial_port::operator=(serial_port&& other) noexcept {
  std::swap(channel_, other.channel_);
  return *this;
}

void serial_port::start(callbacks x) {
  assert(channel_ && x.on_octets && x.on_closed);
  channel_->start(
      std::move(x.on_octets), [on_closed = std::move(x.on_closed)](const error_code& error) {
        on_closed(error == asio::error::eof ? "the other end was closed" : error.message());
      });
}

void serial_port::read(bool wanted) {
  assert(channel_);
  channel_->read(wanted);
}

bool serial_port::send(payload octets) {
  assert(channel_);
  return channel_->send(std::move(octets));
}

} // namespace rubicon::io
