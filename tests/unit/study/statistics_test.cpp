#include <vector>

#include "study/statistics.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::study;

TEST_CASE("quantiles of Student's t are those of printed tables", "[study]") {
  // NIST/SEMATECH e-Handbook of Statistical Methods 1.3.6.7.2, two-sided
  struct row {
    double confidence;
    std::size_t freedom;
    double t;
  };
  for (const auto& each : std::vector<row>{{0.95, 1, 12.706},
                                           {0.95, 2, 4.303},
                                           {0.95, 3, 3.182},
                                           {0.95, 4, 2.776},
                                           {0.95, 9, 2.262},
                                           {0.95, 29, 2.045},
                                           {0.95, 100, 1.984},
                                           {0.99, 1, 63.657},
                                           {0.99, 10, 3.169},
                                           {0.90, 5, 2.015},
                                           {0.90, 60, 1.671}}) {
    CAPTURE(each.confidence, each.freedom);
    CHECK(student_t(each.confidence, each.freedom) == Approx(each.t).margin(0.0006));
  }
  CHECK(student_t(0.95, 1001) == Approx(student_t(0.95, 1000)).epsilon(1e-5));
  CHECK(student_t(0.95, 100'000'000) == Approx(1.959964).epsilon(1e-6));
}

TEST_CASE("the tail of Student's t is what is outside of its quantile", "[study]") {
  for (const std::size_t freedom : {1U, 2U, 3U, 10U, 29U, 999U, 1000U, 1001U, 100'000U})
    for (const double confidence : {0.5, 0.9, 0.95, 0.999}) {
      CAPTURE(freedom, confidence);
      CHECK(student_tail(student_t(confidence, freedom), freedom) ==
            Approx(1 - confidence).margin(freedom > 1000 ? 1e-4 : 1e-9));
      CHECK(student_tail(-student_t(confidence, freedom), freedom) ==
            Approx(1 - confidence).margin(1e-4));
    }
  CHECK(student_tail(0, 5) == Approx(1));
  CHECK(student_tail(1e9, 5) < 1e-15);
}

TEST_CASE("a mean has the interval of Student's t", "[study]") {
  const std::vector<double> values{2, 4, 4, 4, 5, 5, 7, 9}; // deviation 2.13809
  const auto x = mean_of(values);
  CHECK(x.runs == 8);
  CHECK(x.mean == Approx(5));
  REQUIRE(x.half_width.has_value());
  CHECK(*x.half_width == Approx(2.364624 * 2.13809 / 2.828427).epsilon(1e-5));
  const std::vector<double> one{3};
  CHECK(mean_of(one).mean == 3);
  CHECK(!mean_of(one).half_width);
  CHECK(mean_of({}).runs == 0);
  const std::vector<double> equal(5, 0.1);
  CHECK(*mean_of(equal).half_width == Approx(0).margin(1e-15));
}

TEST_CASE("a difference in pairs is not blurred by what both have in common", "[study]") {
  const std::vector<double> a{1, 10, 100, 1000};
  const std::vector<double> b{2, 11, 101, 1001};
  const auto x = paired_difference(a, b);
  CHECK(x.mean == Approx(1));
  CHECK(*x.half_width == Approx(0).margin(1e-9));
  CHECK(*mean_of(a).half_width > 100);
}

TEST_CASE("a quantile lies between the nearest values", "[study]") {
  const std::vector<double> values{4, 1, 3, 2};
  CHECK(quantile(values, 0) == 1);
  CHECK(quantile(values, 1) == 4);
  CHECK(quantile(values, 0.5) == Approx(2.5));
  CHECK(quantile(std::vector<double>{7}, 0.9) == 7);
}

TEST_CASE("a bootstrap has the same interval for the same seed, around the quantile", "[study]") {
  std::vector<double> values;
  for (int i = 0; i <= 100; ++i)
    values.push_back(i);
  random_stream random(7);
  const auto x = bootstrap_quantile(values, 0.5, random);
  CHECK(x.low < 50);
  CHECK(x.low > 35); // the interval of the median by order statistics: 40 to 60
  CHECK(x.high > 50);
  CHECK(x.high < 65);
  random_stream again(7);
  const auto y = bootstrap_quantile(values, 0.5, again);
  CHECK(x.low == y.low);
  CHECK(x.high == y.high);
}
