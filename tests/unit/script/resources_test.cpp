// What a script has besides its layer, without any script.
#include <string>

#include "script/resources.hpp"
#include "support/catch.hpp"

namespace rubicon::script {
namespace {

using numbers = std::vector<std::uint32_t>;

} // namespace

TEST_CASE("timers of a script expire in the order of their times, and once if late", "[script]") {
  resources x;
  CHECK(!x.deadline());
  const auto later = x.add_timer(instant(1s), 3s, false, 10);
  const auto again = x.add_timer(instant(1s), 2s, true, 11);
  REQUIRE(later);
  REQUIRE(again);
  CHECK(x.deadline() == instant(3s));
  CHECK(x.due(instant(2s)).empty());
  CHECK(x.due(instant(8s)) == numbers{*again, *later});
  const auto expired = x.expire(*again, instant(8s));
  REQUIRE(expired);
  CHECK(expired->function == 11);
  CHECK(!expired->is_last);
  CHECK(x.due(instant(8s)) == numbers{*later});
  CHECK(x.expire(*later, instant(8s))->is_last);
  CHECK(!x.expire(*later, instant(8s)));
  CHECK(x.deadline() == instant(9s)); // 3 s and three periods
  CHECK(x.remove_timer(*again) == 11);
  CHECK(!x.remove_timer(*again));
  CHECK(!x.deadline());
}

TEST_CASE("timers, figures and notices of a script are bounded", "[script]") {
  resources x;
  for (std::size_t i = 0; i < timers_max; ++i)
    CHECK(x.add_timer(instant{}, 1s, true, 1));
  CHECK(!x.add_timer(instant{}, 1s, true, 1));
  CHECK(x.remove_timer(1));
  CHECK(x.add_timer(instant{}, 1s, true, 1) == timers_max + 1); // numbers are not used again

  for (std::size_t i = 0; i < figures_max; ++i)
    CHECK(x.set_figure("figure " + std::to_string(i), 0) == nullptr);
  CHECK(x.set_figure("one more", 0) != nullptr);
  CHECK(x.set_figure("figure 0", 2) == nullptr); // it is there
  CHECK(x.figures().size() == figures_max);
  CHECK(x.figures().front().value == 2);

  for (std::size_t i = 0; i < notices_max; ++i)
    CHECK(x.add_notice() == nullptr);
  CHECK(x.add_notice() != nullptr);
  x.begin_event();
  CHECK(x.add_notice() == nullptr);
}

TEST_CASE("names of a script's figures are printable, and not those of its program", "[script]") {
  resources x;
  CHECK(x.set_figure(std::string(text_max, 'a'), 0) == nullptr);
  for (const auto& name : {std::string(), std::string(text_max + 1, 'a'), std::string("a\nb"),
                           std::string("events"), std::string("instructions")}) {
    CAPTURE(name);
    CHECK(x.set_figure(name, 0) != nullptr);
  }
  CHECK(x.figures().size() == 1);
}

} // namespace rubicon::script
