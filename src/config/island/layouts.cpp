#include "config/island/layouts.hpp"

#include <algorithm>
#include <cmath>

#include "core/numbers/math.hpp"
#include "core/numbers/random.hpp"

namespace rubicon::config {

namespace {

constexpr metres spacing_kind{0.01, 100'000};
constexpr metres radius_kind{0, 100'000};

position moved(const position& from, double x_m, double y_m, double z_m = 0) {
  return {from.x_m + x_m, from.y_m + y_m, from.z_m + z_m};
}

/// `radius_m` from the centre in the direction of `turns` of a full turn.
position around(const position& centre, double radius_m, double turns) {
  return moved(centre, radius_m * math::sine_of_turns(turns + 0.25),
               radius_m * math::sine_of_turns(turns));
}

/// The smallest number whose square is at least `x`.
std::size_t square_side(std::size_t x) {
  std::size_t side = 1;
  while (side * side < x)
    ++side;
  return side;
}

void read_grid(table_reader& in, std::vector<position>& out) {
  auto columns = square_side(out.size());
  double spacing_m = 1;
  position origin;
  in.optional("columns", whole<std::size_t>{1, mote_id_max}, columns,
              {"motes along x; further rows follow along y", "as square as possible"});
  in.required("spacing", spacing_kind, spacing_m, "between neighbours");
  in.optional("origin", place{}, origin, "of the first mote");
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = moved(origin, spacing_m * static_cast<double>(i % columns),
                   spacing_m * static_cast<double>(i / columns));
}

void read_line(table_reader& in, std::vector<position>& out) {
  double spacing_m = 1;
  position origin;
  position step{1, 0, 0};
  in.required("spacing", spacing_kind, spacing_m, "between neighbours");
  in.optional("origin", place{}, origin, "of the first mote");
  in.optional("direction",
              word<position>{
                  {{"x", position{1, 0, 0}}, {"y", position{0, 1, 0}}, {"z", position{0, 0, 1}}}},
              step, "along which axis");
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto way_m = spacing_m * static_cast<double>(i);
    out[i] = moved(origin, step.x_m * way_m, step.y_m * way_m, step.z_m * way_m);
  }
}

void read_ring(table_reader& in, std::vector<position>& out) {
  double radius_m = 0;
  position centre;
  in.required("radius", radius_kind, radius_m, "from the centre");
  in.optional("centre", place{}, centre,
              "position of the first mote, in the direction of x from here");
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = around(centre, radius_m, static_cast<double>(i) / static_cast<double>(out.size()));
}

void read_disk(table_reader& in, std::vector<position>& out, const layout_rng& rng) {
  double radius_m = 0;
  position centre;
  in.required("radius", radius_kind, radius_m, "from the centre");
  in.optional("centre", place{}, centre, "its middle");
  random_stream stream(rng.seed, rng.path);
  for (auto& each : out) {
    const auto share = std::sqrt(stream.unit()); // as many within half the radius as its area holds
    each = around(centre, radius_m * share, stream.unit());
  }
}

bool is_far(const position& x) {
  constexpr double farthest_m = 1e6; // as in place
  return std::max({std::abs(x.x_m), std::abs(x.y_m), std::abs(x.z_m)}) > farthest_m;
}

} // namespace

std::vector<position> read_layout(table_reader& in, std::size_t count, const layout_rng& rng) {
  std::vector<position> out(count);
  const auto before = in.problems().size();
  in.one_of("layout", "arrangement of the motes; optional with `model = \"gains\"`",
            {{"grid", [&](table_reader& x) { read_grid(x, out); }},
             {"line", [&](table_reader& x) { read_line(x, out); }},
             {"ring", [&](table_reader& x) { read_ring(x, out); }},
             {"disk", [&](table_reader& x) { read_disk(x, out, rng); }}},
            {}, false);
  if (in.problems().size() != before)
    return {};
  if (std::any_of(out.begin(), out.end(), is_far)) {
    in.problems().add(in.at("layout"), "the layout reaches beyond 1000000 m");
    return {};
  }
  return out;
}

} // namespace rubicon::config
