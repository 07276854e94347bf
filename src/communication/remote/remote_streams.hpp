// Streams of a program in an actor of its own, on its side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "communication/process.hpp"
#include "communication/remote/remote_exchange.hpp"
#include "communication/remote_messages.hpp"
#include "core/time.hpp"

namespace rubicon::communication {

class remote_streams final : public stream_commands {
public:
  explicit remote_streams(remote_exchange& exchange) : exchange_(exchange) {}

  int open_end(const stream_end& end) override;
  int open_sensor(std::uint8_t transducer, std::uint32_t period_ms, stream::sampling kind) override;
  int open_local() override;
  status close(int desc) override;
  status read(int desc, std::size_t nbytes) override;
  status write(int desc, byte_view record) override;
  [[nodiscard]] bool has_ended(int desc) const override;
  [[nodiscard]] std::optional<duration> latency_bound(int desc) const override;

  void apply(const remote::stream_opened& x);
  void apply(const remote::record_read& x);
  void apply(const remote::stream_ended& x);

private:
  enum class kind : std::uint8_t { sensor, local, writer, reader };

  struct row {
    kind what = kind::local;
    bool is_opening = false;
    bool has_ended = false;
    bool is_reading = false;
    std::size_t record_max = 0;
    std::uint16_t name = 0;          ///< of a remote one
    remote::open_sensor sensor = {}; ///< of a sensor stream
    std::optional<duration> latency_bound = {};
  };

  [[nodiscard]] bool has_stream(kind what, std::uint16_t name) const;

  remote_exchange& exchange_;
  numbered_rows<row> streams_;
};

} // namespace rubicon::communication
