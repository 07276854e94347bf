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

/// What a layout may say; each has some of it.
struct layout_form {
  std::size_t columns = 0;
  double spacing_m = 1;
  double radius_m = 0;
  position origin = {}; ///< or centre
  position step = {1, 0, 0};
};

auto layout_grid_keys() {
  using x = layout_form;
  return keys::of(
      keys::optional("columns", &x::columns, whole<std::size_t>{1, mote_id_max},
                     {"motes along x; further rows follow along y", "as square as possible"}),
      keys::required("spacing", &x::spacing_m, spacing_kind, "between neighbours"),
      keys::optional("origin", &x::origin, place{}, "of the first mote"));
}

auto layout_line_keys() {
  using x = layout_form;
  return keys::of(keys::required("spacing", &x::spacing_m, spacing_kind, "between neighbours"),
                  keys::optional("origin", &x::origin, place{}, "of the first mote"),
                  keys::optional("direction", &x::step,
                                 word<position>{{{"x", position{1, 0, 0}},
                                                 {"y", position{0, 1, 0}},
                                                 {"z", position{0, 0, 1}}}},
                                 "along which axis"));
}

/// @param meaning the sentence of `centre`
auto layout_circle_keys(const char* meaning) {
  using x = layout_form;
  return keys::of(keys::required("radius", &x::radius_m, radius_kind, "from the centre"),
                  keys::optional("centre", &x::origin, place{}, meaning));
}

void read_grid(table_reader& in, std::vector<position>& out) {
  layout_form form{.columns = square_side(out.size())};
  in.all(form, layout_grid_keys());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = moved(form.origin, form.spacing_m * static_cast<double>(i % form.columns),
                   form.spacing_m * static_cast<double>(i / form.columns));
}

void read_line(table_reader& in, std::vector<position>& out) {
  layout_form form;
  in.all(form, layout_line_keys());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto way_m = form.spacing_m * static_cast<double>(i);
    out[i] =
        moved(form.origin, form.step.x_m * way_m, form.step.y_m * way_m, form.step.z_m * way_m);
  }
}

void read_ring(table_reader& in, std::vector<position>& out) {
  layout_form form;
  in.all(form, layout_circle_keys("position of the first mote, in the direction of x from here"));
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = around(form.origin, form.radius_m,
                    static_cast<double>(i) / static_cast<double>(out.size()));
}

void read_disk(table_reader& in, std::vector<position>& out, const layout_rng& rng) {
  layout_form form;
  in.all(form, layout_circle_keys("its middle"));
  random_stream stream(rng.seed, rng.path);
  for (auto& each : out) {
    const auto share = std::sqrt(stream.unit()); // as many within half the radius as its area holds
    each = around(form.origin, form.radius_m * share, stream.unit());
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
