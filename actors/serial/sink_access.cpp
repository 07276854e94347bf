#include "actors/serial/sink_access.hpp"

#include <optional>
#include <utility>
#include <variant>

#include "actors/messages/serial.hpp"
#include "core/text/host_port.hpp"
#include "io/serial/serial_port.hpp"
#include "io/tcp/tcp_connect.hpp"
#include "serial/forwarder.hpp"

namespace rubicon {

namespace {

class device_access : public sink_access {
public:
  device_access(io::loop& loop, const sink_access_config& x, outside_line_actor user)
      : loop_(loop), config_(x), user_(std::move(user)) {}

  void open() override {
    auto x = io::serial_port::open(loop_, config_.outside.device, config_.baud, config_.buffer);
    if (auto* why = std::get_if<std::string>(&x)) {
      post(user_, serial_presence{false, std::move(*why)});
      return;
    }
    port_ = std::get<io::serial_port>(std::move(x));
    port_->start({[this](byte_view octets) {
                    port_->read(false);
                    post(user_, serial_octets{to_bytes(octets)});
                  },
                  [this](const std::string& why) {
                    port_.reset();
                    post(user_, serial_presence{false, config_.outside.device + ": " + why});
                  }});
    post(user_, serial_presence{true, {}});
  }

  void close() override { port_.reset(); }

  bool send(const payload& octets) override { return port_ && port_->send(octets); }

  void on_taken() override {
    if (port_)
      port_->read(true);
  }

private:
  io::loop& loop_;
  sink_access_config config_;
  outside_line_actor user_;
  std::optional<io::serial_port> port_;
};

class forwarder_access : public sink_access {
public:
  forwarder_access(io::loop& loop, const sink_access_config& x, outside_line_actor user)
      : loop_(loop), config_(x), user_(std::move(user)) {}

  void open() override {
    constexpr duration patience = 5s;
    const auto where = parse_host_port(config_.outside.forwarder).value();
    attempt_.emplace(loop_, where.host, where.port, patience, [this](auto x) {
      if (auto* why = std::get_if<std::string>(&x))
        lose(*why + ": is a serial forwarder running there?");
      else
        begin(std::get<io::tcp_stream>(std::move(x)));
    });
  }

  void close() override {
    attempt_.reset();
    stream_.reset();
    greeted_ = false;
  }

  bool send(const payload& octets) override {
    if (!stream_ || stream_->unsent() + octets.size() > config_.buffer)
      return false;
    auto todo = line_.on_pc(octets.view());
    stream_->send(std::move(todo.to_forwarder));
    if (!todo.to_pc.empty())
      post(user_, serial_octets{std::move(todo.to_pc)});
    return true;
  }

  void on_taken() override {
    if (stream_)
      stream_->read(true);
  }

private:
  void begin(io::tcp_stream x) {
    stream_ = std::move(x);
    stream_->start(
        {[this](byte_view octets) { take(octets); }, [](std::size_t) {},
         [this](const std::string& why) { lose(config_.outside.forwarder + ": " + why); }});
    stream_->send(line_.on_connected());
  }

  void take(byte_view octets) {
    auto todo = line_.on_forwarder(octets);
    if (!std::exchange(greeted_, line_.greeted()) && greeted_)
      post(user_, serial_presence{true, {}});
    if (!todo.to_pc.empty()) {
      stream_->read(false);
      post(user_, serial_octets{std::move(todo.to_pc)});
    }
    if (line_.refused() != serial::refusal::none)
      lose(config_.outside.forwarder + ": " + std::string(to_string(line_.refused())));
  }

  void lose(std::string why) {
    close();
    post(user_, serial_presence{false, std::move(why)});
  }

  io::loop& loop_;
  sink_access_config config_;
  outside_line_actor user_;
  serial::forwarder_line line_;
  std::optional<io::tcp_connect> attempt_;
  std::optional<io::tcp_stream> stream_;
  bool greeted_ = false;
};

} // namespace

std::unique_ptr<sink_access> make_access(io::loop& loop, const sink_access_config& x,
                                         outside_line_actor user) {
  if (!x.outside.device.empty())
    return std::make_unique<device_access>(loop, x, std::move(user));
  return std::make_unique<forwarder_access>(loop, x, std::move(user));
}

std::string name_of(const sink_access_config& x) {
  return x.outside.device.empty() ? "serial forwarder " + x.outside.forwarder
                                  : x.outside.device + ", " + std::to_string(x.baud) + " baud";
}

} // namespace rubicon
