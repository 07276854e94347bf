// A program that uses its node through mote/communication.hpp alone, so that it runs on motes and
// on PCs alike (PAR-05).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/app_config.hpp"
#include "apps/streams/stream_end.hpp"
#include "communication/interface.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"

namespace rubicon::apps {

/// Something a program has counted or measured, for the report.
struct figure {
  std::string name; ///< with its unit, if it has one: `records lost`
  double value = 0;
  bool counts = true; ///< so that it may be added to that of an earlier life

  friend bool operator==(const figure&, const figure&) = default;
};

/// Where readings and states go: the PC of the own island, which is its gateway (RTG-03).
inline constexpr mote_address own_gateway{own_island, no_mote};

/// Whoever hosts a program attaches it, starts it, calls on_time() at its deadline, and flushes the
/// layer after each of these.
class application : public communication::communication_events {
public:
  /// @param layer of the node this program was attached to
  void start(communication::interface layer, instant now) {
    layer_ = layer;
    on_start(now);
  }

  [[nodiscard]] bool wants_ticks() const override { return false; }

  virtual void on_time(instant /*now*/) {} ///< harmless before deadline()
  [[nodiscard]] virtual std::optional<instant> deadline() const { return std::nullopt; }

  [[nodiscard]] virtual std::vector<figure> figures() const { return {}; }

  /// Its ends of streams whose other end is a program's too. @param now by its node's clock
  [[nodiscard]] virtual std::vector<stream_end> stream_ends(instant /*now*/) const { return {}; }

  /// Lines for the event log, since the last call.
  [[nodiscard]] std::vector<std::string> take_notices() { return std::exchange(notices_, {}); }

  /// Lines for the log, of what should not be, since the last call.
  [[nodiscard]] std::vector<std::string> take_warnings() { return std::exchange(warnings_, {}); }

  /// Where its lines go; empty: nowhere. Its host begins an empty file with the heading.
  [[nodiscard]] virtual std::string_view file() const { return {}; }
  [[nodiscard]] virtual std::string_view file_heading() const { return {}; }
  [[nodiscard]] virtual std::string take_lines() { return {}; } ///< since the last call

protected:
  virtual void on_start(instant now) = 0;
  [[nodiscard]] communication::interface& layer() { return *layer_; }
  void notify(std::string what) { notices_.push_back(std::move(what)); }
  void warn(std::string what) { warnings_.push_back(std::move(what)); } ///< `event=lost number=3`

  /// As layer().provide(); warns if the type is another's.
  void provide(std::uint8_t am_type) {
    if (layer().provide(am_type) == communication::FAIL)
      warn("event=claim_refused am_type=" + std::to_string(am_type));
  }

private:
  std::optional<communication::interface> layer_;
  std::vector<std::string> notices_;
  std::vector<std::string> warnings_;
};

[[nodiscard]] std::unique_ptr<application> make_application(const app_config& config,
                                                            random_stream rng);

} // namespace rubicon::apps
