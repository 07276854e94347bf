#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "core/numbers/random.hpp"
#include "study/comparison.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::study;

namespace {

std::vector<double> normal_values(random_stream& random, std::size_t runs, double mean) {
  std::vector<double> out(runs);
  for (auto& each : out)
    each = mean + random.normal();
  return out;
}

/// Figures of two programs that are the same, under other seeds.
std::vector<paired_figure> equal_programs(random_stream& random) {
  std::vector<paired_figure> out;
  for (int i = 0; i < 40; ++i)
    out.push_back({"", "figure " + std::to_string(i), normal_values(random, 20, 10),
                   normal_values(random, 20, 10)});
  return out;
}

bool covers(const interval& x, double truth) {
  return x.low <= truth && truth <= x.high;
}

/// How many of 100 studies have an interval that covers the truth.
template <class Study>
double covering(Study has_truth) {
  constexpr int studies = 4000;
  int found = 0;
  for (int i = 0; i < studies; ++i)
    found += has_truth() ? 1 : 0;
  return 100.0 * found / studies;
}

} // namespace

TEST_CASE("what is the same under the same seeds has no difference", "[study]") {
  random_stream random(1);
  for (int i = 0; i < 100; ++i) {
    const auto values = normal_values(random, 20, 10);
    const auto x = compare({{"", "one", values, values}, {"", "none", {}, {}}});
    CHECK(x.figures == 2);
    CHECK(x.differing.empty());
  }
}

TEST_CASE("among equal programs under other seeds hardly ever any figure is sure", "[study]") {
  random_stream random(2);
  int wrong = 0;
  for (int i = 0; i < 100; ++i)
    wrong += compare(equal_programs(random)).sure > 0 ? 1 : 0;
  CHECK(wrong <= 10); // 5 are expected; of 4 000 single figures 200 would be
}

TEST_CASE("a difference is found among many figures, the greatest first", "[study]") {
  random_stream random(3);
  auto all = equal_programs(random);
  all[17].b = normal_values(random, 20, 12);
  all[5].b = normal_values(random, 20, 20);
  const auto x = compare(all);
  CHECK(x.figures == 40);
  CHECK(x.sure == 2);
  REQUIRE(x.differing.size() == 40);
  CHECK(x.differing[0].name == "figure 5");
  CHECK(x.differing[0].relative() == Approx(0.5).margin(0.05));
  CHECK(x.differing[1].name == "figure 17");
  CHECK(x.differing[1].is_sure);
  CHECK(x.differing[1].of_pairs.mean == Approx(2).margin(1));
  CHECK(!x.differing[2].is_sure);
  CHECK(std::is_sorted(x.differing.begin() + 2, x.differing.end(),
                       [](const auto& a, const auto& b) { return a.p < b.p; }));
}

TEST_CASE("few runs prove nothing, however equal their differences", "[study]") {
  const auto x = compare({{"", "one", {1, 2, 3}, {2, 3, 4}}});
  REQUIRE(x.differing.size() == 1);
  CHECK(x.differing[0].p == Approx(0.25));
  CHECK(!x.differing[0].is_sure);
  CHECK(compare({{"", "one", {1}, {2}}}).differing[0].p == 1);
  const auto many = compare({{"", "one", std::vector<double>(8, 1), std::vector<double>(8, 2)}});
  CHECK(many.differing[0].p == Approx(1.0 / 128));
  CHECK(many.differing[0].is_sure);
}

TEST_CASE("chances are corrected as Holm has it", "[study]") {
  // eight pairs of which all differ by one: p of the sign test is 1/128 each
  const std::vector<double> a(8, 1);
  const std::vector<double> b(8, 2);
  const auto x = compare({{"", "one", a, b}, {"", "two", a, b}, {"v", "two", a, a}});
  REQUIRE(x.differing.size() == 2);
  CHECK(x.differing[0].p == Approx(2.0 / 128));
  CHECK(x.differing[1].p == Approx(2.0 / 128)); // not below the one before
}

TEST_CASE("intervals cover the truth in 93 to 97 of 100 studies", "[study]") {
  random_stream random(4);
  const auto within = [](double x) { return x >= 93 && x <= 97; };
  const auto mean = covering([&] {
    const auto x = mean_of(normal_values(random, 10, 5));
    return covers({x.mean - *x.half_width, x.mean + *x.half_width}, 5);
  });
  CAPTURE(mean);
  CHECK(within(mean));
  const auto pairs = covering([&] {
    const auto a = normal_values(random, 10, 5);
    auto b = normal_values(random, 10, 0.5);
    std::ranges::transform(a, b, b.begin(), std::plus());
    const auto x = paired_difference(a, b);
    return covers({x.mean - *x.half_width, x.mean + *x.half_width}, 0.5);
  });
  CAPTURE(pairs);
  CHECK(within(pairs));
}

TEST_CASE("intervals of quantiles cover the truth in 93 to 97 of 100 studies", "[study]") {
  random_stream random(5);
  int median = 0;
  int difference = 0;
  constexpr int studies = 600;
  for (int i = 0; i < studies; ++i) {
    const auto a = normal_values(random, 50, 5);
    const auto b = normal_values(random, 50, 6);
    median += covers(bootstrap_quantile(a, 0.5, random, 200), 5) ? 1 : 0;
    difference += covers(bootstrap_difference(a, b, 0.5, random, 200), 1) ? 1 : 0;
  }
  CHECK(median >= 0.93 * studies);
  CHECK(median <= 0.97 * studies);
  CHECK(difference >= 0.93 * studies);
  CHECK(difference <= 0.97 * studies);
}

TEST_CASE("pairs are runs of one variant and seed", "[study]") {
  using side = figure_pairs::side;
  figure_pairs x;
  x.add(side::b, "loss=0", 2, {{"events", 22}, {"only b", 1}});
  x.add(side::a, "loss=0", 2, {{"events", 20}});
  x.add(side::a, "loss=0", 1, {{"events", 9}});
  x.add(side::a, "loss=0", 1, {{"events", 10}});
  x.add(side::b, "loss=0", 1, {{"events", 11}});
  x.add(side::a, "loss=1", 1, {{"events", 1}});
  CHECK(x.pairs() == 2);
  CHECK(x.single() == 1);
  const auto all = x.all();
  REQUIRE(all.size() == 1);
  CHECK(all[0].variant == "loss=0");
  CHECK(all[0].name == "events");
  CHECK(all[0].a == std::vector<double>{10, 20});
  CHECK(all[0].b == std::vector<double>{11, 22});
}

TEST_CASE("pairs of very many runs are bounded", "[study]") {
  using side = figure_pairs::side;
  figure_pairs x;
  for (std::uint64_t seed = 0; seed < figure_pairs::runs_max + 3; ++seed)
    x.add(side::a, "", seed, {});
  x.add(side::b, "", 7, {});
  CHECK(x.left_out() == 3);
  CHECK(x.pairs() == 1);
}
