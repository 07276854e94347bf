// Subscribes to tuples, so that its kernel holds the newest value of each, and counts them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/component.hpp"

namespace rubicon::proxy {

/// Asks gateways for its period whenever they list a mote whose outputs its keys name.
class collector final : public components::component {
public:
  static constexpr std::size_t collected_max = 10'000;

  /// @param keys of any owner @param every 0: it asks for no period
  collector(std::vector<std::string> keys, duration every)
      : keys_(std::move(keys)), every_(every) {}

  [[nodiscard]] components::outputs start(instant now) override;
  [[nodiscard]] components::outputs on_tuple(const components::news& x, instant now) override;
  [[nodiscard]] components::figures figures() const override;

private:
  [[nodiscard]] components::outputs ask_for_period(const components::news& x) const;

  std::vector<std::string> keys_;
  duration every_{};
  std::set<std::string> collected_; ///< `owner:key` of each tuple there is, at most collected_max
  std::uint64_t updates_ = 0;
};

} // namespace rubicon::proxy
