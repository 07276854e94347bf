#include "goal/component.hpp"

namespace rubicon::goal {

namespace {

/// Numbers of watches: on the goal; and for each input, beginning with input_first, one on the
/// tuple that it is and one on its meta tuple.
constexpr std::uint64_t watch_goal = 0;
constexpr std::uint64_t input_first = 1;

std::size_t input_of(std::uint64_t watch) {
  return (watch - input_first) / 2;
}

struct converter {
  const pursuer& core;

  components::output operator()(const publish& x) const {
    return components::publish{x.key, to_bytes(std::string_view(x.text))};
  }
  components::output operator()(const declare& x) const {
    return components::declare{x.key, x.reference, x.target};
  }
  components::output operator()(const begun& x) const { return notice("goal: " + x.goal); }
  components::output operator()(const ended& x) const {
    const auto cause =
        x.cause == goal_cause::none ? std::string() : ": " + std::string(to_string(x.cause));
    return notice(x.goal + ' ' + std::string(to_string(x.outcome)) + cause);
  }

  [[nodiscard]] components::output notice(std::string what) const {
    return components::tell{std::move(what), core.config().name};
  }
};

} // namespace

components::outputs component::outputs_of(const outputs& all) const {
  components::outputs out;
  for (const auto& x : all)
    out.push_back(std::visit(converter{core_}, x));
  return out;
}

components::outputs component::start(instant now) {
  auto out = outputs_of(core_.start(now));
  out.emplace_back(components::watch{watch_goal, self_, core_.goal_key()});
  for (std::size_t i = 0; i < core_.config().inputs.size(); ++i) {
    const auto key = core_.meta_key(i);
    const auto number = input_first + 2 * i;
    out.emplace_back(components::watch{number + 1, self_, key, components::watched::reference});
    out.emplace_back(components::watch{number, self_, key, components::watched::target});
  }
  return out;
}

components::outputs component::on_tuple(const components::news& x, instant now) {
  if (x.watch == watch_goal)
    return x.deleted ? components::outputs{} : outputs_of(core_.on_goal(x.text, now));
  const source from{x.owner, std::string(x.key)};
  if (!x.deleted)
    return outputs_of(core_.on_input(input_of(x.watch), from, x.text, now));
  core_.on_input_gone(input_of(x.watch), from);
  return {};
}

void component::on_reference(std::uint64_t watch, const std::optional<components::tuple_name>& to) {
  core_.on_reference(input_of(watch),
                     to ? std::optional(source{to->owner, to->key}) : std::nullopt);
}

components::outputs component::on_time(instant now) {
  return outputs_of(core_.on_time(now));
}

components::figures component::figures() const {
  components::figures out;
  components::add_figures<goal::pursuer_counters>(out, core_.counters());
  out.emplace_back("open", static_cast<double>(core_.open_goals()));
  return out;
}

} // namespace rubicon::goal
