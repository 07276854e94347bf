#include "scheduler/messages/spawn.hpp"

#include "scheduler/coordinator.hpp"

namespace rubicon::scheduler {

void place(actor& who, std::string path, process& where) {
  who.place(std::move(path), where, where.owner().trace());
}

caf::execution_unit* unit_of(process& x) {
  return &x.queue().unit();
}

} // namespace rubicon::scheduler
