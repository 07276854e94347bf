#include "bridge/mqtt/broker_site.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "core/overloads.hpp"

namespace rubicon::bridge {

broker_site::broker_site(std::vector<simulated_event> events) : events_(std::move(events)) {
  std::ranges::stable_sort(events_, {}, time_of);
}

std::optional<simulated_event> broker_site::take(instant now) {
  const auto due = deadline();
  return due && *due <= now ? std::optional(events_[next_++]) : std::nullopt;
}

std::optional<instant> broker_site::deadline() const {
  return next_ < events_.size() ? std::optional(instant(time_of(events_[next_]))) : std::nullopt;
}

void broker_site::catch_up(instant now) {
  while (const auto event = take(now))
    std::visit(overloads{[this](const broker_restart& x) {
                           broker_.restart(x.keeps == kept_messages::retained);
                         },
                         [this](const other_publication& x) {
                           static_cast<void>(broker_.publish({x.topic, x.payload}, x.retain));
                         }},
               *event);
}

} // namespace rubicon::bridge
