#include "scheduler/spawn.hpp"

#include "scheduler/coordinator.hpp"

namespace rubicon::scheduler {

void place(caf::abstract_actor& who, std::string path) {
  auto* traced = dynamic_cast<traced_base*>(&who);
  if (traced == nullptr)
    return;
  const auto* owner = coordinator::of(who.home_system());
  traced->place(std::move(path), owner != nullptr ? owner->trace() : nullptr);
}

} // namespace rubicon::scheduler
