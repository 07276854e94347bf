#include <algorithm>

#include "config/model_readers.hpp"

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

mote::field_source read_source(table_reader& in) {
  using mote::falloff;
  mote::field_source out;
  in.required("position_m", place{}, out.place, "where it is");
  in.required("strength", real{}, out.strength, "what it adds at its own place");
  in.optional("radius", metres{0.01, 100'000}, out.radius_m,
              "how far it reaches, as `falloff` has it");
  in.optional("falloff",
              word<falloff>{{{"inverse_square", falloff::inverse_square},
                             {"gaussian", falloff::gaussian},
                             {"linear", falloff::linear},
                             {"disk", falloff::disk}}},
              out.shape,
              "share of the strength at the distance d: 1 / (1 + (d / r)^2), exp(-(d / r)^2 / 2), "
              "1 - d / r up to r, or all of it up to r");
  in.optional(
      "schedule", time_points{}, out.schedule,
      {"factor of the strength, in straight lines as in [`model = \"points\"`](#model--points)",
       "always 1", "`[[\"0s\", 0], [\"1h\", 1]]`, at least 1"});
  in.optional("period", time_span{1ms}, out.period,
              {"the schedule begins again", "it does not repeat",
               "time from 1 ms, not before the schedule's end"});
  if (in.sound() && out.period > 0s && out.schedule.empty())
    in.problems().add(in.at("period"), "`period` means nothing without a `schedule`");
  else if (in.sound() && out.period > 0s && out.period < out.schedule.back().first)
    in.problems().add(in.at("period"), "`period` must not be shorter than the `schedule`, which "
                                       "ends at " +
                                           to_text(out.schedule.back().first));
  return out;
}

} // namespace

mote::field_model read_field(table_reader& in) {
  mote::field_model out;
  in.required("base", real{}, out.base, "value far from all sources, at the origin");
  in.optional("gradient", gradient{}, out.gradient_per_m, {"change per metre", "`[0, 0]`"});
  in.tables("sources", "sources", {"heaters, lamps, people", "none"},
            [&out](table_reader& x) { out.sources.push_back(read_source(x)); });
  return out;
}

} // namespace rubicon::config
