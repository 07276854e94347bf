#include <algorithm>
#include <variant>

#include "config/checks/warnings.hpp"

namespace rubicon::config {

namespace {

/// Programs of users and of SMEPP Light may have any AM type.
bool may_take(const mote_description& mote, std::uint8_t am_type) {
  return std::ranges::any_of(mote.apps, [am_type](const mote_app& app) {
    if (const auto* listener = std::get_if<listener_app>(&app))
      return listener->am_type == am_type;
    if (const auto* actuator = std::get_if<actuator_app>(&app))
      return actuator->channel == am_type;
    return std::holds_alternative<apps::app_config>(app) ||
           std::holds_alternative<separate_app>(app) || std::holds_alternative<member_app>(app);
  });
}

} // namespace

void warn_of_messages(const ecology_description& x, const file_places& seen, warning_list& out) {
  const auto look_at = [&](const island_description& from, const mote_description& sender,
                           const messenger_app& messages) {
    for (const auto& island : x.islands) {
      const auto to = std::ranges::find(island.motes, messages.to.mote, &mote_description::id);
      if (island.id != messages.to.island || to == island.motes.end() ||
          island.outside.has_sink() || may_take(*to, messages.am_type))
        continue;
      const auto place = seen.motes.find({from.id, sender.id});
      out.emplace_back(place == seen.motes.end() ? mark() : place->second.at,
                       from.name + '/' + sender.name + " sends messages of AM type " +
                           std::to_string(messages.am_type) + " to " + island.name + '/' +
                           to->name + ", where no program accepts them");
    }
  };
  for (const auto& island : x.islands)
    for (const auto& mote : island.motes)
      for (const auto& app : mote.apps)
        if (const auto* messages = std::get_if<messenger_app>(&app))
          look_at(island, mote, *messages);
}

} // namespace rubicon::config
