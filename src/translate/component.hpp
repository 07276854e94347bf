// Translations beside a kernel (SVC-09).
#pragma once

#include <utility>

#include "core/component.hpp"
#include "translate/translator.hpp"

namespace rubicon::translate {

class component final : public components::component {
public:
  /// @param self owner of what it publishes
  component(translator core, peer_id self) : core_(std::move(core)), self_(self) {}

  [[nodiscard]] components::outputs start(instant now) override;
  [[nodiscard]] components::outputs on_tuple(const components::news& x, instant now) override;
  [[nodiscard]] components::figures figures() const override;

private:
  translator core_;
  peer_id self_;
};

} // namespace rubicon::translate
