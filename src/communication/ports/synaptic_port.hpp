// Synaptic channels of a node's programs, and the ticks at which they carry vectors (D1.1 5.3.1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "communication/ports/channel_port.hpp"
#include "communication/ports/local_node.hpp"
#include "communication/ports/program_list.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/small_map.hpp"
#include "core/time.hpp"
#include "synaptic/channels.hpp"
#include "transport/messenger.hpp"

namespace rubicon::communication {

/// Where vectors of a node go, as far as they go to other nodes.
struct vector_end {
  std::size_t size = 0; ///< elements
  bool connected = false;
  std::optional<stream::channel_handle> channel{}; ///< of Network; nothing: through the sink
};

/// Which program has created which channel; who is notified of ticks.
class synaptic_port final : public channel_user {
public:
  /// @param messages which knows how slow answers of an island are
  synaptic_port(local_node& node, program_list& programs, channel_port& channels,
                const transport::messenger& messages, const synaptic::channels_config& config)
      : node_(node), programs_(programs), channels_(channels), messages_(messages),
        synaptic_(config) {}

  // Commands of a program.
  /// @returns a descriptor, or -1
  int create(std::size_t program, bool is_out, mote_address other, std::uint8_t size,
             const synaptic::parameters& params);
  status dispose(synaptic::descriptor channel);
  status start(synaptic::descriptor channel);
  status stop(synaptic::descriptor channel);
  status write_output(synaptic::descriptor channel, std::uint8_t k, float value);
  /// NaN: there is none.
  float read_input(synaptic::descriptor channel, std::uint8_t index);
  void leave(std::size_t program);

  void on_connected(std::uint16_t descriptor, stream::channel_handle channel) override;
  void on_connect_failed(std::uint16_t descriptor) override;
  void on_accepted(stream::channel_handle channel, mote_address source,
                   duration far_slack) override;
  void on_octets(stream::channel_handle channel, byte_view octets) override;
  void on_closed(stream::channel_handle channel) override;

  /// Inputs are reported before the tick: who computes at the tick has them. Programs get it before
  /// anything is sent: what they write leaves at this tick, in any slot.
  void on_tick(std::uint32_t tick, instant now);
  /// Whether on_tick() matters here: a synaptic channel is open, or a program asks for it.
  [[nodiscard]] bool wants_ticks() const;
  /// How long after a tick vectors leave; slot_min at least.
  void set_slot(duration offset);
  [[nodiscard]] std::vector<vector_end> vector_ends() const;

  void on_time();
  [[nodiscard]] std::optional<instant> deadline() const { return synaptic_.deadline(); }
  void set_answer_slack(duration x) { synaptic_.set_answer_slack(x); }

  [[nodiscard]] const synaptic::channels& core() const { return synaptic_; }

private:
  status accept(synaptic::answer x);
  void apply(synaptic::outputs todo);

  local_node& node_;
  program_list& programs_;
  channel_port& channels_;
  const transport::messenger& messages_;
  synaptic::channels synaptic_;
  small_map<synaptic::descriptor, std::size_t> owners_;
};

} // namespace rubicon::communication
