// Programs with synaptic channels: they create them when their node has joined, and anew when one
// is gone.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "apps/application.hpp"

namespace rubicon::apps {

/// What parts of an echo-state network have in common.
class synaptic_application : public application {
public:
  [[nodiscard]] bool wants_ticks() const final { return true; }
  void on_time(instant now) final;
  [[nodiscard]] std::optional<instant> deadline() const final { return retry_; }
  [[nodiscard]] std::vector<figure> figures() const override;

  void joined(communication::island_octet island, std::uint16_t mote,
              communication::status success) override;
  void createSynChannelOutDone(int channel, communication::status success) final;
  void createSynChannelInDone(int channel, communication::status success) final;
  void synChannelFailed(int channel) final;
  void syn_input_update(int channel, std::uint8_t index, synaptic::input_status status) final;

protected:
  struct end {
    synapse what;
    bool is_out = false;
    int channel = -1;
    bool is_open = false;
  };

  synaptic_application(const std::vector<synapse>& from, const std::vector<synapse>& to);

  [[nodiscard]] const std::vector<end>& ends() const { return ends_; } ///< in ends first
  [[nodiscard]] bool all_open() const;
  void count_tick() { ++ticks_; } ///< with all channels open
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }

private:
  void on_start(instant) final {}
  void open_all(); ///< those that are not
  void close_all();
  void on_created(int channel, bool success);
  void lose(end& x);

  std::vector<end> ends_;
  std::optional<instant> retry_;
  std::uint64_t losses_ = 0;
  std::uint64_t ticks_ = 0;
  std::uint64_t updated_ = 0; ///< vectors; the next too
  std::uint64_t missed_ = 0;
};

} // namespace rubicon::apps
