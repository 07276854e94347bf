// Messages and small actors for the tests of the scheduler.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "scheduler/world.hpp"
#include "support/catch.hpp"

namespace scheduler_test {

using namespace rubicon;
using namespace rubicon::scheduler;

struct mark {
  int value = 0;
};
RUBICON_FIELDS(mark, value);

struct text {
  std::string words;
  double number = 0;
  payload octets;
};
RUBICON_FIELDS(text, words, number, octets);

struct mark_interface : takes<mark> {};
using mark_actor = ref<mark_interface>;

struct introduction {
  int value = 0;
  mark_actor who;
  int after = 0;
};
RUBICON_FIELDS(introduction, value, who, after);

/// As `mark`, but another type.
struct stain {
  int value = 0;
};
RUBICON_FIELDS(stain, value);

struct any_interface : takes<mark, text, introduction, stain> {};
using any_actor = ref<any_interface>;

/// What happened: when and which.
using event = std::pair<duration, int>;
using events = std::vector<event>;

template <class Self>
duration time_of(Self* self) {
  return self->now().time_since_epoch();
}

using mark_pointer = actor_pointer<no_state, mark_actor>;

/// Writes down every mark it gets, `offset` added.
inline mark_actor::behavior_type recorder(mark_pointer self, events* log, int offset) {
  return {[=](mark x) { log->emplace_back(time_of(self), x.value + offset); }};
}

/// Counts how many of it are alive.
struct counted_state {
  counted_state() { ++alive; }
  counted_state(const counted_state&) = delete;
  counted_state& operator=(const counted_state&) = delete;
  ~counted_state() { --alive; }

  mark_actor friend_of_mine;
  inline static int alive = 0;
};

using counted_pointer = actor_pointer<counted_state, mark_actor>;

/// Does nothing about a mark.
inline mark_actor::behavior_type mute(counted_pointer) {
  return {[](mark) {}};
}

} // namespace scheduler_test
