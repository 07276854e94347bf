// A sink behind a serial port or a serial forwarder, for commands without an ecology.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "cli/serial_command.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "io/loop.hpp"
#include "io/serial/serial_port.hpp"
#include "io/tcp/tcp_connect.hpp"
#include "io/tcp/tcp_stream.hpp"
#include "serial/forwarder.hpp"
#include "serial/host_port.hpp"
#include "serial/reopening.hpp"

namespace rubicon::cli {

class sink_source {
public:
  /// Called from within step(), never from within another call.
  struct callbacks {
    std::function<void(const bytes&)> on_packet = [](const bytes&) {};
    /// @param why it is not with the mote, or the forwarder; nothing: it is
    std::function<void(serial::packet_id, std::optional<serial::lost_cause> why)> on_done =
        [](serial::packet_id, std::optional<serial::lost_cause>) {};
    /// In words, each piece once: why there is no sink, and that there is one again.
    std::function<void(const std::string&)> on_news = [](const std::string&) {};
  };

  /// When a sink cannot be had, or has gone.
  enum class patience {
    none,       ///< lost() says so
    for_a_sink, ///< it is asked for again and again, as a gateway does
  };

  sink_source(const serial_command& with, patience how, callbacks x);

  [[nodiscard]] instant now() const;
  [[nodiscard]] bool is_there() const { return there_; }

  /// Why there is none; empty: there is one, or nothing is known yet.
  [[nodiscard]] const std::string& lost() const { return lost_; }
  [[nodiscard]] io::loop& loop() { return loop_; }

  /// A forwarder's packets are done without an ack of the mote: it reports none.
  void send(serial::packet_id id, bytes packet);

  /// Waits for something to happen, until `end` at the latest.
  void step(instant end);

private:
  using clock = std::chrono::steady_clock;

  void open();
  void open_device();
  void connect();
  void on_stream(io::tcp_stream found);
  void on_forwarded(byte_view octets);
  void found();
  void lose(std::string why);
  void on_lost(const std::string& why);
  void report_done(serial::packet_id id, std::optional<serial::lost_cause> why);
  void perform(serial::outputs todo);

  serial_command with_;
  patience how_;
  callbacks to_user_;
  io::loop loop_;
  serial::host_port port_;
  clock::time_point start_ = clock::now();
  bool there_ = false;
  std::string lost_;
  std::optional<instant> next_try_;
  serial::reopening reopening_;
  std::optional<io::serial_port> device_;
  serial::forwarder_decoder decoder_;
  std::unique_ptr<io::tcp_connect> attempt_;
  std::unique_ptr<io::tcp_stream> stream_;
};

} // namespace rubicon::cli
