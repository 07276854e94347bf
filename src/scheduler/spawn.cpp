#include "scheduler/spawn.hpp"

#include "scheduler/coordinator.hpp"

namespace rubicon::scheduler {

process& process_of(caf::abstract_actor& who) {
  const auto* const traced = dynamic_cast<const traced_base*>(&who);
  return traced != nullptr && traced->where() != nullptr
             ? *traced->where()
             : coordinator::of(who.home_system())->supervisor();
}

void place(caf::abstract_actor& who, std::string path, process& where) {
  if (auto* const traced = dynamic_cast<traced_base*>(&who))
    traced->place(std::move(path), where, where.owner().trace());
}

} // namespace rubicon::scheduler
