// A pursuer of goals beside the kernel of a robot that is not there (SVC-10).
#pragma once

#include <utility>

#include "core/component.hpp"
#include "goal/pursuer.hpp"

namespace rubicon::goal {

class component final : public components::component {
public:
  /// @param self owner of its goal and inputs
  component(pursuer core, peer_id self) : core_(std::move(core)), self_(self) {}

  [[nodiscard]] components::outputs start(instant now) override;
  [[nodiscard]] components::outputs on_tuple(const components::news& x, instant now) override;
  void on_reference(std::uint64_t watch, const std::optional<components::tuple_name>& to) override;
  [[nodiscard]] components::outputs on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override { return core_.deadline(); }
  [[nodiscard]] components::figures figures() const override;

private:
  [[nodiscard]] components::outputs outputs_of(const outputs& all) const;

  pursuer core_;
  peer_id self_;
};

} // namespace rubicon::goal
