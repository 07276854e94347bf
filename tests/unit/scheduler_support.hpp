// Messages and small actors for the tests of the scheduler.
#pragma once

#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <caf/all.hpp>

#include "actors/inspect.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "scheduler/supervision.hpp"
#include "scheduler/world.hpp"
#include "support/catch.hpp"

namespace scheduler_test {

using namespace rubicon;
using namespace rubicon::scheduler;

struct mark {
  int value = 0;
};

struct text {
  std::string words;
  double number = 0;
  payload octets;
};

template <class Inspector>
typename Inspector::result_type inspect(Inspector& f, mark& x) {
  return f(caf::meta::type_name("mark"), x.value);
}

template <class Inspector>
typename Inspector::result_type inspect(Inspector& f, text& x) {
  return f(caf::meta::type_name("text"), x.words, x.number, x.octets);
}

using mark_actor = caf::typed_actor<caf::reacts_to<mark>>;

struct introduction {
  int value = 0;
  carried<mark_actor> who;
  int after = 0;
};

template <class Inspector>
typename Inspector::result_type inspect(Inspector& f, introduction& x) {
  return f(caf::meta::type_name("introduction"), x.value, x.who, x.after);
}

} // namespace scheduler_test

CAF_BEGIN_TYPE_ID_BLOCK(scheduler_test, caf::first_custom_type_id)
CAF_ADD_TYPE_ID(scheduler_test, (scheduler_test::mark))
CAF_ADD_TYPE_ID(scheduler_test, (scheduler_test::text))
CAF_ADD_TYPE_ID(scheduler_test, (scheduler_test::introduction))
CAF_ADD_TYPE_ID(scheduler_test, (scheduler_test::mark_actor))
CAF_END_TYPE_ID_BLOCK(scheduler_test)

namespace scheduler_test {

/// What happened: when and which.
using event = std::pair<duration, int>;
using events = std::vector<event>;

template <class Self>
duration time_of(Self* self) {
  return to_instant(self->clock().now()).time_since_epoch();
}

/// Writes down every mark it gets, `offset` added.
inline mark_actor::behavior_type recorder(mark_actor::pointer self, events* log, int offset) {
  return {[=](mark x) { log->emplace_back(time_of(self), x.value + offset); }};
}

/// Counts how many of it are alive.
struct counted_state {
  counted_state() { ++alive; }
  counted_state(const counted_state&) = delete;
  counted_state& operator=(const counted_state&) = delete;
  ~counted_state() { --alive; }

  caf::actor friend_of_mine;
  inline static int alive = 0;
};

using counted_pointer = caf::stateful_actor<counted_state>*;

} // namespace scheduler_test
