// A program of the Communication Layer that writes down what it is told.
#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "communication/interface.hpp"

namespace rubicon::test {

inline constexpr std::uint8_t user_am_type = 64; ///< one that programs may take

class recorder : public communication::communication_events {
public:
  struct message {
    mote_address source;
    std::uint8_t am_type = 0;
    bytes octets;
  };
  struct opening {
    int descriptor = 0;
    std::uint16_t name = 0;
    bool success = false;

    friend bool operator==(const opening&, const opening&) = default;
  };
  struct reading {
    int descriptor = 0;
    bytes record;
    bool success = false;
  };

  void receiveFrom(mote_address source, byte_view octets, std::uint8_t am_type) override {
    messages.push_back({source, am_type, to_bytes(octets)});
  }
  void ack(communication::status x) override { acks.push_back(x == communication::SUCCESS); }
  void ackOf(std::uint32_t number, communication::status x) override {
    acks_of.emplace_back(number, x == communication::SUCCESS);
  }
  void openRemoteDone(int descriptor, std::uint16_t name, communication::status x) override {
    openings.push_back({descriptor, name, x == communication::SUCCESS});
    if (reads_all && x == communication::SUCCESS)
      static_cast<void>(layer->read(descriptor, 256));
  }
  void readDone(int descriptor, byte_view record, communication::status x) override {
    readings.push_back({descriptor, to_bytes(record), x == communication::SUCCESS});
    if (reads_all && x == communication::SUCCESS)
      static_cast<void>(layer->read(descriptor, 256));
  }
  void createSynChannelOutDone(int channel, communication::status x) override {
    outs.emplace_back(channel, x == communication::SUCCESS);
  }
  void createSynChannelInDone(int channel, communication::status x) override {
    ins.emplace_back(channel, x == communication::SUCCESS);
  }
  void syn_input_update(int channel, std::uint8_t index, synaptic::input_status x) override {
    const bool is_new = x == synaptic::input_status::updated;
    ++(is_new ? updated : missed);
    if (is_new)
      inputs.push_back(layer->read_input(channel, index));
  }
  void synChannelFailed(int channel) override { failed.push_back(channel); }
  void clock_tick(std::uint32_t tick) override {
    ticks.emplace_back(tick, layer->now());
    if (on_tick)
      on_tick(tick);
  }
  void initCommunicationsDone(communication::status x) override {
    inits.push_back(x == communication::SUCCESS);
  }
  void joined(communication::island_octet island, std::uint16_t mote,
              communication::status x) override {
    joins.emplace_back(mote_address{island_id(island), mote_id(mote)}, x == communication::SUCCESS);
  }
  void outputsWanted(std::span<const communication::output_wanted> all) override {
    wanted.emplace_back(all.begin(), all.end());
  }
  void moteJoined(std::uint16_t mote, byte_view description) override {
    newcomers.emplace_back(mote, to_bytes(description));
  }

  std::optional<communication::interface> layer;
  bool reads_all = false; ///< of each stream, as it comes
  std::function<void(std::uint32_t)> on_tick;

  std::vector<message> messages;
  std::vector<bool> acks;
  std::vector<std::pair<std::uint32_t, bool>> acks_of;
  std::vector<opening> openings;
  std::vector<reading> readings;
  std::vector<std::pair<int, bool>> outs; ///< channel, success
  std::vector<std::pair<int, bool>> ins;
  std::size_t updated = 0; ///< elements
  std::size_t missed = 0;
  std::vector<float> inputs;
  std::vector<int> failed;
  std::vector<std::pair<std::uint32_t, instant>> ticks;
  std::vector<bool> inits;
  std::vector<std::pair<mote_address, bool>> joins;
  std::vector<std::pair<std::uint16_t, bytes>> newcomers;
  std::vector<std::vector<communication::output_wanted>> wanted;
};

} // namespace rubicon::test
