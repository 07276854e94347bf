#include "config/doubts.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include "config/placement.hpp"
#include "config/tuple_keys.hpp"
#include "core/spelling.hpp"
#include "proxy/layout.hpp"

namespace rubicon::config {

namespace {

/// Octets of the longest message that a mote's programs send on each channel; nothing: nobody
/// knows.
std::map<std::uint16_t, std::size_t> messages_of(const mote_description& mote) {
  std::map<std::uint16_t, std::size_t> found;
  const auto add = [&found](std::uint16_t channel, std::size_t octets) {
    found[channel] = std::max(found[channel], octets);
  };
  for (const auto& app : mote.apps) {
    if (const auto* x = std::get_if<sampler_app>(&app))
      add(x->channel, 2 * x->transducers.size() + (x->stamped ? 4 : 0));
    else if (const auto* y = std::get_if<actuator_app>(&app))
      add(y->channel, 1);
  }
  return found;
}

/// Messages that may come to a gateway are not those of these programs alone.
bool may_send_anything(const mote_description& mote) {
  return std::ranges::any_of(mote.apps, [](const auto& app) {
    return std::holds_alternative<apps::app_config>(app) ||
           std::holds_alternative<separate_app>(app) ||
           std::holds_alternative<member_app>(app); // values of whatever length
  });
}

class doubter {
public:
  explicit doubter(const ecology_description& x) : all_(x), keys_(tuple_keys(x)) {
    for (const auto& each : keys_)
      if (each.pattern.find('*') == std::string::npos)
        exact_.push_back(each.pattern);
  }

  std::vector<std::string> take() {
    for (const auto& island : all_.islands)
      look_at_groups(island);
    for (const auto& island : all_.islands)
      for (const auto& mote : island.motes)
        look_at(island, mote);
    if (!strangers_may_come()) {
      for (const auto& peer : all_.peers)
        look_at(peer);
      for (const auto& each : all_.expectations)
        look_at(each);
    }
    return std::move(found_);
  }

private:
  /// Members look for a group until somebody has created it in their island.
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
        doubt("no member of group `" + group + "` in island " + island.name +
              " has `creates = true`");
  }

  void doubt(std::string what) {
    if (found_.size() < doubts_max && std::ranges::find(found_, what) == found_.end())
      found_.push_back(std::move(what));
  }

  [[nodiscard]] bool strangers_may_come() const {
    return std::ranges::any_of(all_.peers, [](const peer_description& x) {
      return x.tcp || x.lan || !x.connect.empty() ||
             std::ranges::any_of(x.apps, [](const peer_app& app) {
               const auto* init = std::get_if<init_app>(&app);
               return init != nullptr && std::ranges::any_of(init->components, [](const auto& y) {
                        return y.peer.empty();
                      });
             });
    });
  }

  /// Kernels and inits tell of themselves.
  [[nodiscard]] static bool is_of_kernel(std::string_view key) {
    for (const auto* first : {"kernel", "peis", "components", "name"})
      if (may_be(std::string(first) + ".**", key) || may_be(first, key))
        return true;
    return key.starts_with('*'); // of whatever kernels tell, too
  }

  void look_for(const std::string& who, const char* does, const std::string& key) {
    const bool known = std::ranges::any_of(
        keys_, [&key](const known_key& each) { return may_be(each.pattern, key); });
    if (known || is_of_kernel(key))
      return;
    doubt(who + ' ' + does + " `" + key + "`, a tuple that nobody has" +
          (exact_.empty() ? "" : suggestion(key, exact_)));
  }

  void look_at(const peer_description& peer) {
    for (const auto& app : peer.apps) {
      if (const auto* rules = std::get_if<proxy::rules_config>(&app)) {
        for (const auto& rule : rules->rules) {
          if (!rule.when.empty())
            look_for("a rule of " + peer.name, "waits for", rule.when);
          for (const auto& write : rule.writes) {
            look_for("a rule of " + peer.name, write.meta ? "points" : "writes", write.key);
            if (!write.from.empty())
              look_for("a rule of " + peer.name, "reads", write.from);
          }
        }
      } else if (const auto* collector = std::get_if<collector_app>(&app)) {
        for (const auto& key : collector->keys)
          look_for("the collector of " + peer.name, "reads", key);
      } else if (const auto* translate = std::get_if<translate_app>(&app)) {
        for (const auto& rule : translate->rules)
          look_for("a translation of " + peer.name, "reads", rule.from);
      }
    }
  }

  void look_at(const expectation& x) {
    const auto* tuple = std::get_if<tuple_expectation>(&x);
    if (tuple == nullptr)
      return;
    look_for("an expectation", "looks at", tuple->then.key);
    if (tuple->when)
      look_for("an expectation", "looks at", tuple->when->key);
  }

  /// nullptr: nobody starts proxies of its motes.
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

  void look_at(const island_description& island, const mote_description& mote) {
    const auto* const manager = manager_of(island.id);
    if (island.stack != stack::full || island.outside.has_sink() || manager == nullptr)
      return;
    const auto* what = class_of(all_, island.id, mote);
    if (what == nullptr) {
      const auto kind = mote.type_name.empty()
                            ? std::to_string(mote.type)
                            : mote.type_name + " (" + std::to_string(mote.type) + ')';
      if (!unclaimed_.insert(kind).second)
        return; // one mote of a kind will do
      doubt("no [[proxy]] claims motes of type " + kind + ", as " + island.name + '/' + mote.name +
            " is one");
      return;
    }
    const auto named = [what](const proxy::field& x) {
      return "field `" + x.name + "` of [[proxy]] `" + what->name + '`';
    };
    for (const auto& field : what->fields)
      if (field.stream && !is_written(field.stream->number, manager->id))
        doubt(named(field) + ": no program writes stream " + std::to_string(field.stream->number) +
              " to " + manager->name);
    if (may_send_anything(mote))
      return;
    const auto messages = messages_of(mote);
    for (const auto& field : what->fields) {
      if (field.stream)
        continue;
      const auto who = named(field);
      const auto sent = messages.find(field.channel);
      if (sent == messages.end())
        doubt(who + ": no program of " + of_kind(island, mote) + " sends on channel " +
              std::to_string(field.channel));
      else if (field.offset + proxy::octets_of(field.layout) > sent->second)
        doubt(who + " ends at octet " +
              std::to_string(field.offset + proxy::octets_of(field.layout)) + ", but messages of " +
              of_kind(island, mote) + " on channel " + std::to_string(field.channel) + " have " +
              std::to_string(sent->second));
    }
    for (const auto& input : what->inputs) {
      const bool is_heard = std::ranges::any_of(mote.apps, [&input](const mote_app& app) {
        const auto* actuator = std::get_if<actuator_app>(&app);
        const auto* listener = std::get_if<listener_app>(&app);
        return (actuator != nullptr && actuator->channel == input.channel) ||
               (listener != nullptr && listener->am_type == input.channel);
      });
      if (!is_heard)
        doubt("input `" + input.name + "` of [[proxy]] `" + what->name + "`: no program of " +
              of_kind(island, mote) + " listens on channel " + std::to_string(input.channel));
    }
  }

  /// Of many motes alike one sentence will do.
  static std::string of_kind(const island_description& island, const mote_description& mote) {
    return mote.type_name.empty() ? island.name + '/' + mote.name
                                  : "motes of type " + mote.type_name;
  }

  const ecology_description& all_;
  std::vector<known_key> keys_;
  std::vector<std::string> exact_;
  std::set<std::string> unclaimed_; ///< types told of
  std::vector<std::string> found_;
};

} // namespace

std::vector<std::string> doubts(const ecology_description& x) {
  auto found = doubter(x).take();
  for (const auto& each : placement_problems(x))
    if (found.size() < doubts_max)
      found.push_back("on several hosts it cannot run: " + each);
  return found;
}

} // namespace rubicon::config
