#include <algorithm>

#include "config/model_readers.hpp"

namespace rubicon::config {

namespace {

/// [a, b] or [a, b, c], values per metre
struct gradient {
  using type = std::array<double, 3>;

  [[nodiscard]] static std::optional<type> read(const node& x, const asker& who) {
    constexpr double steepest = 1e6;
    const auto found = list_of<real>{{-steepest, steepest}, 2, 3}.read(x, who);
    if (!found)
      return std::nullopt;
    type out{};
    std::ranges::transform(*found, out.begin(), &located<double>::value);
    return out;
  }
};

mote::field_source read_source(table_reader& in) {
  using mote::falloff;
  mote::field_source out;
  in.required("position_m", place{}, out.place);
  in.required("strength", real{}, out.strength);
  in.optional("radius", metres{0.01, 100'000}, out.radius_m);
  in.optional("falloff",
              word<falloff>{{{"inverse_square", falloff::inverse_square},
                             {"gaussian", falloff::gaussian},
                             {"linear", falloff::linear},
                             {"disk", falloff::disk}}},
              out.shape);
  in.optional("schedule", time_points{}, out.schedule);
  in.optional("period", time_span{1ms}, out.period);
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
  in.required("base", real{}, out.base);
  in.optional("gradient", gradient{}, out.gradient_per_m);
  in.tables("sources", "sources",
            [&out](table_reader& x) { out.sources.push_back(read_source(x)); });
  return out;
}

} // namespace rubicon::config
