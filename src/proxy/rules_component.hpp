// Rules beside a kernel: watches tuples and writes others when conditions come to hold.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/component.hpp"
#include "proxy/rules.hpp"

namespace rubicon::proxy {

/// Writes at the owners of tuples, which it finds by watching these too.
class rules_component final : public components::component {
public:
  explicit rules_component(rules core) : rules_(std::move(core)) {}

  [[nodiscard]] components::outputs start(instant now) override;
  [[nodiscard]] components::outputs on_tuple(const components::news& x, instant now) override;
  [[nodiscard]] components::outputs on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override { return rules_.deadline(); }

private:
  void on_gone(const components::news& x);
  [[nodiscard]] components::outputs outputs_of(const std::vector<write_tuple>& writes) const;

  rules rules_;
  std::map<std::string, peer_id> owners_; ///< of the tuples to write, as far as they are known
};

} // namespace rubicon::proxy
