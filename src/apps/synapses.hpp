// The synaptic channels of a program: created when its node has joined, created anew when one is
// gone.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "apps/app_config.hpp"
#include "core/time.hpp"
#include "mote/communication.hpp"

namespace rubicon::apps {

class synapses {
public:
  synapses() = default;
  synapses(const std::vector<synapse>& from, const std::vector<synapse>& to);

  void open_all(mote::communication& layer); ///< those that are not
  void close_all(mote::communication& layer);

  void on_created(mote::communication& layer, int channel, bool success);
  void on_failed(mote::communication& layer, int channel);

  void on_time(mote::communication& layer, instant now);
  [[nodiscard]] std::optional<instant> deadline() const { return retry_; }

  struct end {
    synapse what;
    bool is_out = false;
    int channel = -1;
    bool is_open = false;
  };
  [[nodiscard]] const std::vector<end>& ends() const { return ends_; } ///< in ends first
  [[nodiscard]] std::uint64_t failures() const { return failures_; }
  [[nodiscard]] bool all_open() const;

private:
  std::vector<end> ends_;
  std::optional<instant> retry_;
  std::uint64_t failures_ = 0;
};

} // namespace rubicon::apps
