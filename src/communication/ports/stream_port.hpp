// Streams of a node's programs (D1.1 5.3.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "communication/ports/channel_port.hpp"
#include "communication/ports/local_node.hpp"
#include "communication/ports/program_list.hpp"
#include "core/bytes.hpp"
#include "core/small_map.hpp"
#include "core/time.hpp"
#include "stream/sensor_record.hpp"
#include "stream/streams.hpp"
#include "transport/messenger.hpp"

namespace rubicon::communication {

/// Which program has opened which stream. A sensor stream may be opened before the island is known.
class stream_port final : public channel_user {
public:
  /// @param messages which knows how slow answers of an island are
  stream_port(local_node& node, program_list& programs, channel_port& channels,
              const transport::messenger& messages, const stream::streams_config& config)
      : node_(node), programs_(programs), channels_(channels), messages_(messages),
        streams_(config) {}

  // Commands of a program; an open returns a descriptor, or -1.
  int open_end(std::size_t program, const stream_end& end);
  int open_sensor(std::size_t program, std::uint8_t transducer, std::uint32_t period_ms,
                  stream::sampling kind);
  int open_local(std::size_t program);
  status close(stream::descriptor stream);
  status read(stream::descriptor stream, std::size_t octets);
  status write(stream::descriptor stream, byte_view record);
  void leave(std::size_t program);
  /// As interface has it.
  [[nodiscard]] std::optional<duration> latency_bound(stream::descriptor stream) const;

  void on_connected(std::uint16_t descriptor, stream::channel_handle channel) override;
  void on_connect_failed(std::uint16_t descriptor) override;
  void on_accepted(stream::channel_handle channel, mote_address source,
                   duration far_slack) override;
  void on_octets(stream::channel_handle channel, byte_view octets) override;
  void on_closed(stream::channel_handle channel) override;

  void on_sample(stream::descriptor stream, const stream::sensor_record& x);
  void on_time();
  [[nodiscard]] std::optional<instant> deadline() const { return streams_.deadline(); }
  void set_answer_slack(duration x) { streams_.set_answer_slack(x); }

  [[nodiscard]] const stream::streams& core() const { return streams_; }

private:
  int accept_open(std::size_t program, stream::answer x);
  status accept(stream::answer x);
  void apply(stream::outputs todo);
  void on_read(stream::read_done& x);

  local_node& node_;
  program_list& programs_;
  channel_port& channels_;
  const transport::messenger& messages_;
  stream::streams streams_;
  small_map<stream::descriptor, std::size_t> owners_;
};

} // namespace rubicon::communication
