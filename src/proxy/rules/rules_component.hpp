// Rules beside a kernel: watches tuples and writes others when conditions come to hold.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/component.hpp"
#include "proxy/rules/rules.hpp"

namespace rubicon::proxy {

/// Writes at the owners of tuples, which it finds by watching these too.
class rules_component final : public components::component {
public:
  /// @param away_since when an earlier life of it ended
  explicit rules_component(rules core, std::optional<instant> away_since = {})
      : rules_(std::move(core)), away_since_(away_since) {}

  [[nodiscard]] components::outputs start(instant now) override;
  [[nodiscard]] components::outputs on_tuple(const components::news& x, instant now) override;
  [[nodiscard]] components::outputs on_written(std::uint64_t token, std::string_view cause,
                                               instant now) override;
  [[nodiscard]] components::outputs on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override { return rules_.deadline(); }
  [[nodiscard]] components::figures figures() const override;

private:
  /// Who has a tuple to write.
  struct owner {
    peer_id id;
    bool is_there = true;    ///< else its tuple is gone, for now
    std::uint64_t asked = 0; ///< token of the newest write
  };

  void on_gone(const components::news& x, instant now);
  [[nodiscard]] components::outputs outputs_of(const std::vector<write_tuple>& writes, instant now);

  rules rules_;
  std::optional<instant> away_since_;
  std::map<std::string, owner> owners_; ///< of the tuples to write, as far as they are known
  std::uint64_t tokens_ = 0;
};

} // namespace rubicon::proxy
