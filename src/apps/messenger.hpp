// Sends a text to a mote again and again.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "apps/application.hpp"
#include "core/describe/changes.hpp"

namespace rubicon::apps {

/// Sends every period while its mote is in an island, the first time one period after it has
/// joined, and up to `count` messages; warns of what is not delivered.
class messenger final : public application {
public:
  explicit messenger(messenger_config config) : config_(std::move(config)) {}

  /// Some of its settings are others from now on. With a new period the next message is sent one
  /// period from now.
  void change(const keys::key_changes& settings);

  void on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override;

  void joined(communication::island_octet island, std::uint16_t mote,
              communication::status success) override;
  void ackOf(std::uint32_t number, communication::status success) override;

private:
  void on_start(instant) override {}
  void send();

  messenger_config config_;
  bool begins_ = false;         ///< its periods do, at the next on_time()
  std::optional<instant> next_; ///< nothing: it rests
  std::uint64_t sent_ = 0;
  std::map<std::uint32_t, std::uint64_t> in_flight_; ///< which message a reliable send is
};

} // namespace rubicon::apps
