#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <variant>

#include "config/checks/tuple_keys.hpp"
#include "config/checks/warnings.hpp"
#include "config/plan/counts.hpp"
#include "config/plan/uniqueness.hpp"
#include "proxy/classes/layout.hpp"

namespace rubicon::config {

namespace {

/// Octets of the longest message that a mote's programs send on each channel, without the time that
/// a sampler adds.
std::map<std::uint16_t, std::size_t> messages_of(const mote_description& mote) {
  std::map<std::uint16_t, std::size_t> found;
  const auto add = [&found](std::uint16_t channel, std::size_t octets) {
    found[channel] = std::max(found[channel], octets);
  };
  for (const auto& app : mote.apps) {
    if (const auto* x = std::get_if<sampler_app>(&app))
      add(x->channel, 2 * x->transducers.size());
    else if (const auto* y = std::get_if<actuator_app>(&app))
      add(y->channel, 1);
  }
  return found;
}

class proxy_warnings {
public:
  proxy_warnings(const ecology_description& x, const file_places& seen, warning_list& out)
      : all_(x), seen_(seen), out_(out), classes_(x) {}

  void look() {
    for (const auto& island : all_.islands)
      look_at_groups(island);
    for (const auto& island : all_.islands)
      for (const auto& mote : island.motes)
        look_at(island, mote);
    for (const auto& what : all_.proxies)
      look_at(what);
    tell_shared_keys();
  }

private:
  void warn(mark at, std::string what) {
    if (std::ranges::find(out_, what, &config::warning::second) == out_.end())
      out_.emplace_back(at, std::move(what));
  }

  /// Members look for a group until a member has created it in their island.
  void look_at_groups(const island_description& island) {
    std::map<std::string, bool> created;
    for (const auto& mote : island.motes)
      for (const auto& app : mote.apps)
        if (const auto* member = std::get_if<member_app>(&app)) {
          auto& is_created = created[member->group];
          is_created = is_created || member->creates;
        }
    for (const auto& [group, is_created] : created)
      if (!is_created)
        warn({}, "no member of group `" + group + "` in island " + island.name +
                     " has `creates = true`");
  }

  /// nullptr: no proxy manager serves its motes.
  [[nodiscard]] const peer_description* manager_of(island_id island) const {
    const auto manages = [island](const peer_app& app) {
      const auto* manager = std::get_if<proxy_manager_app>(&app);
      return manager != nullptr &&
             std::ranges::find(manager->islands, island) != manager->islands.end();
    };
    const auto found = std::ranges::find_if(all_.peers, [&](const peer_description& peer) {
      return std::ranges::any_of(peer.apps, manages);
    });
    return found == all_.peers.end() ? nullptr : &*found;
  }

  /// Whether a mote's program may write the stream to the peer.
  [[nodiscard]] bool is_written(std::uint16_t stream, peer_id to) const {
    const mote_address reader{island_id(static_cast<std::uint32_t>(to.value)), no_mote};
    const auto writes = [&](const apps::app_config& x) {
      if (const auto* writer = std::get_if<apps::stream_writer_config>(&x))
        return writer->stream == stream && writer->to == reader;
      if (const auto* average = std::get_if<apps::average_config>(&x))
        return std::ranges::any_of(average->outputs, [&](const auto& output) {
          return output.stream == stream && output.to == reader;
        });
      return std::holds_alternative<apps::custom_config>(x);
    };
    return std::ranges::any_of(all_.islands, [&](const island_description& island) {
      return std::ranges::any_of(island.motes, [&](const mote_description& mote) {
        return std::ranges::any_of(mote.apps, [&](const mote_app& app) {
          if (const auto* separate = std::get_if<separate_app>(&app))
            return writes(separate->program);
          const auto* program = std::get_if<apps::app_config>(&app);
          return program != nullptr && writes(*program);
        });
      });
    });
  }

  [[nodiscard]] mark place_of(const proxy::proxy_class& x) const {
    const auto found = seen_.classes.find(x.name);
    return found == seen_.classes.end() ? mark() : found->second.at;
  }
  [[nodiscard]] mark place_of(const proxy::proxy_class& x, const proxy::field& field) const {
    const auto found = seen_.classes.find(x.name);
    const auto at = found == seen_.classes.end() ? decltype(found->second.fields.end())()
                                                 : found->second.fields.find(field.name);
    return found == seen_.classes.end() || at == found->second.fields.end() ? place_of(x)
                                                                            : at->second;
  }
  [[nodiscard]] mark place_of(const proxy::proxy_class& x, const proxy::input& input) const {
    const auto found = seen_.classes.find(x.name);
    const auto at = found == seen_.classes.end() ? decltype(found->second.inputs.end())()
                                                 : found->second.inputs.find(input.name);
    return found == seen_.classes.end() || at == found->second.inputs.end() ? place_of(x)
                                                                            : at->second;
  }
  [[nodiscard]] mark place_of(const island_description& island,
                              const mote_description& mote) const {
    const auto found = seen_.motes.find({island.id, mote.id});
    return found == seen_.motes.end() ? mark() : found->second.at;
  }

  void look_at(const island_description& island, const mote_description& mote) {
    if (island.stack != stack::full || island.outside.has_sink())
      return;
    const auto* what = classes_.of(mote);
    const auto* const manager = manager_of(island.id);
    if (what != nullptr)
      (manager == nullptr ? unmanaged_ : managed_).emplace(what, island.name + '/' + mote.name);
    if (manager == nullptr)
      return;
    if (what == nullptr) {
      tell_unclaimed(island, mote);
      return;
    }
    auto& sharers = sharers_[folded(prefix_of(*what, island, mote))];
    sharers.push_back({&island, &mote, what});
    for (const auto& field : what->fields)
      if (field.stream && !is_written(field.stream->number, manager->id))
        warn(place_of(*what, field), named(*what, field) + ": no program writes stream " +
                                         std::to_string(field.stream->number) + " to " +
                                         manager->name);
    if (may_send_anything(mote))
      return;
    look_at_fields(island, mote, *what);
    look_at_inputs(island, mote, *what);
  }

  void tell_unclaimed(const island_description& island, const mote_description& mote) {
    const auto kind = mote.type_name.empty()
                          ? std::to_string(mote.type)
                          : mote.type_name + " (" + std::to_string(mote.type) + ')';
    if (unclaimed_.insert(kind).second) // one mote of a kind will do
      warn(place_of(island, mote), "no [[proxy]] claims motes of type " + kind + ", as " +
                                       island.name + '/' + mote.name + " is one");
  }

  static std::string named(const proxy::proxy_class& what, const proxy::field& x) {
    return "field `" + x.name + "` of [[proxy]] `" + what.name + '`';
  }

  void look_at_fields(const island_description& island, const mote_description& mote,
                      const proxy::proxy_class& what) {
    const auto messages = messages_of(mote);
    for (const auto& field : what.fields) {
      if (field.stream)
        continue;
      const auto who = named(what, field);
      const auto sent = messages.find(field.channel);
      const auto end = field.offset + proxy::octets_of(field.layout);
      if (sent == messages.end())
        warn(place_of(what, field), who + ": no program of " + of_kind(island, mote) +
                                        " sends on channel " + std::to_string(field.channel));
      else if (field.layout != proxy::encoding::stamp && end > sent->second)
        warn(place_of(what, field), who + " ends at octet " + std::to_string(end) +
                                        ", but messages of " + of_kind(island, mote) +
                                        " on channel " + std::to_string(field.channel) + " have " +
                                        std::to_string(sent->second) + " of counts");
    }
  }

  void look_at_inputs(const island_description& island, const mote_description& mote,
                      const proxy::proxy_class& what) {
    for (const auto& input : what.inputs) {
      const bool is_heard = std::ranges::any_of(mote.apps, [&input](const mote_app& app) {
        const auto* actuator = std::get_if<actuator_app>(&app);
        const auto* listener = std::get_if<listener_app>(&app);
        return (actuator != nullptr && actuator->channel == input.channel) ||
               (listener != nullptr && listener->am_type == input.channel);
      });
      if (!is_heard)
        warn(place_of(what, input), "input `" + input.name + "` of [[proxy]] `" + what.name +
                                        "`: no program of " + of_kind(island, mote) +
                                        " listens on channel " + std::to_string(input.channel));
    }
  }

  /// Nobody starts any proxy of the class.
  void look_at(const proxy::proxy_class& what) {
    const auto found = unmanaged_.find(&what);
    if (found == unmanaged_.end() || managed_.contains(&what))
      return;
    warn(place_of(what), "no proxy of [[proxy]] `" + what.name +
                             "` is ever started: no peer has "
                             "a \"proxy_manager\" for the island of " +
                             found->second);
  }

  /// Proxies whose tuples have the same keys.
  struct sharer {
    const island_description* island = nullptr;
    const mote_description* mote = nullptr;
    const proxy::proxy_class* what = nullptr;

    [[nodiscard]] std::string name() const { return island->name + '/' + mote->name; }
  };

  void tell_shared_keys() {
    for (const auto& [key, sharers] : sharers_) {
      if (sharers.size() < 2)
        continue;
      const auto& [island, mote, what] = sharers[1];
      const auto at = seen_.classes.find(what->name);
      const auto others = sharers.size() - 2;
      warn(at == seen_.classes.end() ? mark() : at->second.prefix,
           "the proxies of " + sharers[0].name() + " and " + sharers[1].name() +
               (others > 0 ? " and of " + std::to_string(others) + " more" : "") +
               " have the same key, `" + prefix_of(*what, *island, *mote) +
               "`: a write to it reaches all of them, and its value may be from any of them; "
               "`prefix` can contain {island} and {name}");
    }
  }

  /// Of many motes alike one sentence will do.
  static std::string of_kind(const island_description& island, const mote_description& mote) {
    return mote.type_name.empty() ? island.name + '/' + mote.name
                                  : "motes of type " + mote.type_name;
  }

  const ecology_description& all_;
  const file_places& seen_;
  warning_list& out_;
  mote_classes classes_;
  std::set<std::string> unclaimed_;                          ///< types with a warning
  std::map<const proxy::proxy_class*, std::string> managed_; ///< a mote of each
  std::map<const proxy::proxy_class*, std::string> unmanaged_;
  std::map<std::string, std::vector<sharer>> sharers_;
};

} // namespace

void warn_of_proxies(const ecology_description& x, const file_places& seen, warning_list& out) {
  proxy_warnings(x, seen, out).look();
}

} // namespace rubicon::config
