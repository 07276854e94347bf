#include <algorithm>

#include "config/island/model_readers.hpp"
#include "device/transducer_keys.hpp"

namespace rubicon::config {

namespace {

/// [a, b] or [a, b, c], values per metre
struct gradient {
  using type = std::array<double, 3>;

  [[nodiscard]] static std::optional<type> read(const node& x, const asker& who) {
    constexpr double steepest = 1e6;
    const auto found = config::read(list_of<real>{{-steepest, steepest}, 2, 3}, x, who);
    if (!found)
      return std::nullopt;
    type out{};
    std::ranges::transform(*found, out.begin(), &located<double>::value);
    return out;
  }
  [[nodiscard]] static form takes() {
    return form{"`[x, y]` or `[x, y, z]`, each -1e6 to 1e6",
                form_of(list_of<real>{{}, 2, 3}).schema};
  }
};

auto field_model_keys() {
  return keys::of(keys::required("base", &device::field_model::base, real{},
                                 "value far from all sources, at the origin"),
                  keys::optional("gradient", &device::field_model::gradient_per_m, gradient{},
                                 {"change per metre", "`[0, 0]`"}));
}

device::field_source read_source(table_reader& in) {
  using device::falloff;
  device::field_source out;
  in.all(out);
  if (in.sound() && out.period > 0s && out.schedule.empty())
    in.problems().add(in.at("period"), "`period` has no effect without a `schedule`");
  else if (in.sound() && out.period > 0s && out.period < out.schedule.back().first)
    in.problems().add(in.at("period"), "`period` must not be shorter than the `schedule`, which "
                                       "ends at " +
                                           to_text(out.schedule.back().first));
  return out;
}

} // namespace

device::field_model read_field(table_reader& in) {
  device::field_model out;
  in.all(out, field_model_keys());
  in.tables("sources", "sources", {"heaters, lamps, people", "none"},
            [&out](table_reader& x) { out.sources.push_back(read_source(x)); });
  return out;
}

} // namespace rubicon::config
