#include "actors/run/lifetime.hpp"

#include <algorithm>

#include "actors/island/mote.hpp"
#include "actors/run/look.hpp"

namespace rubicon {

namespace {

/// To keep to the same time for so long costs less than to look more often.
constexpr duration soon = 1s;

} // namespace

lifetime::lifetime(scheduler::world& world, config::run_end end)
    : world_(world), is_open_(end == config::run_end::first_flat_battery) {
  if (!is_open_)
    return;
  world_.scheduler().keep_in_order(true); // until there is something to look at
  next_look_ = world_.now() + soon;
}

void lifetime::look(const ecology_state& all) {
  const auto now = world_.now();
  auto first = batteries_last_until(all, now);
  for (const auto at : expected_)
    if (at + last_words_time >= now)
      first = std::min(first, at);
  const bool is_soon = first <= now + soon;
  world_.scheduler().keep_in_order(is_soon);
  next_look_ = is_soon ? now + soon : first;
}

void lifetime::expect_end(instant at) {
  expected_.push_back(at);
  next_look_ = std::min(next_look_, at);
}

void lifetime::on_flat(const std::string& mote) {
  if (!is_open_)
    return;
  is_open_ = false;
  ended_by_ = mote;
  world_.request_stop();
}

} // namespace rubicon
