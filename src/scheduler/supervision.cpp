#include "scheduler/supervision.hpp"

#include <caf/sec.hpp>

namespace rubicon::scheduler {

caf::error failure_of(const std::exception_ptr& x) {
  try {
    std::rethrow_exception(x);
  } catch (const std::exception& e) {
    return caf::make_error(caf::sec::runtime_error, std::string(e.what()));
  } catch (...) {
    return caf::make_error(caf::sec::runtime_error, std::string("unknown exception"));
  }
}

void tell_monitors_of_exceptions(caf::scheduled_actor* self) {
  self->set_exception_handler(
      [](caf::scheduled_actor*, std::exception_ptr& x) { return failure_of(x); });
}

} // namespace rubicon::scheduler
