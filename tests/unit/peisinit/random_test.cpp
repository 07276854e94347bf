// Whatever people write and however components behave: the rules of SVC-01, SVC-04 and SVC-05.
#include <array>
#include <map>
#include <optional>
#include <string>

#include "core/numbers/random.hpp"
#include "peisinit/supervisor.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::peisinit;

namespace {

constexpr std::size_t count = 4;
constexpr duration delay_of_all = 2s;
constexpr duration stop_time_max = 4s;

/// Components that start after a while or not at all, crash, and may ignore all but SIGKILL.
class random_host {
public:
  explicit random_host(std::uint64_t seed) : rng_(seed) {
    std::vector<component> all;
    for (std::size_t i = 0; i < count; ++i) {
      component x;
      x.name = "c" + std::to_string(i);
      x.id = peer_id{static_cast<std::int32_t>(i + 1)};
      if (i % 2 == 0)
        x.peer = x.name;
      x.on = rng_.below(2) == 0;
      x.delay = delay_of_all;
      all.push_back(std::move(x));
    }
    supervisor_ = supervisor(std::move(all));
  }

  void run(instant end) {
    perform(supervisor_.begin(now_));
    while (now_ < end && !over_) {
      next_moment();
      perform(supervisor_.on_time(now_));
      happen();
      check();
    }
  }

  void shut_down() {
    asked_to_end_ = true;
    perform(supervisor_.shut_down(now_));
    for (auto& x : parts_)
      x.off_since = now_;
    const auto latest = now_ + stop_time_max;
    while (now_ < latest && !over_) {
      next_moment();
      perform(supervisor_.on_time(now_));
      happen();
      check();
    }
    CHECK(over_);
    for (std::size_t i = 0; i < count; ++i) {
      CHECK_FALSE(parts_[i].life);
      CHECK(supervisor_.phase_of(i) == phase::off);
    }
  }

private:
  struct one {
    std::optional<std::uint64_t> life; ///< runs
    bool is_running = false;           ///< that it runs
    bool stubborn = false;
    std::optional<instant> crashed;   ///< its last end, unless somebody wrote a state since then
    std::optional<instant> off_since; ///< the last word was `off`
    std::optional<instant> ends_at;
  };

  void next_moment() {
    const auto step = now_ + std::chrono::milliseconds(1 + rng_.below(400));
    const auto due = supervisor_.deadline();
    now_ = due ? std::max(now_, std::min(step, *due)) : step;
  }

  void perform(const outputs& todo) {
    for (const auto& each : todo) {
      if (const auto* x = std::get_if<start>(&each))
        on_start(*x);
      else if (const auto* y = std::get_if<stop>(&each))
        on_stop(*y);
      else if (std::holds_alternative<all_off>(each))
        on_all_off();
    }
  }

  void on_start(const start& x) {
    auto& part = parts_[x.component];
    REQUIRE_FALSE(part.life); // never two
    REQUIRE_FALSE(asked_to_end_);
    if (part.crashed)
      REQUIRE(now_ - *part.crashed >= delay_of_all);
    part.crashed.reset();
    part.life = x.life;
    part.is_running = false;
    part.stubborn = rng_.below(3) == 0;
    part.ends_at.reset();
  }

  void on_stop(const stop& x) {
    auto& part = parts_[x.component];
    if (!part.life)
      return;
    if (x.step == stop_step::kill || (!part.stubborn && rng_.below(3) == 0))
      part.ends_at = now_ + std::chrono::milliseconds(rng_.below(300));
  }

  void on_all_off() {
    REQUIRE_FALSE(over_);
    over_ = true;
    for (const auto& part : parts_)
      REQUIRE_FALSE(part.life);
  }

  void happen() {
    for (std::size_t i = 0; i < count; ++i) {
      auto& part = parts_[i];
      if (part.life && (!part.is_running && rng_.below(2) == 0)) {
        part.is_running = true;
        perform(supervisor_.on_started(i, *part.life, 0));
      }
      if (part.life && ((part.ends_at && *part.ends_at <= now_) || rng_.below(30) == 0))
        end(i);
    }
    const auto who = rng_.below(count);
    static constexpr std::array words{"on", "off", "start", "abort", "what", "OFF"};
    if (rng_.below(4) == 0)
      write(who, words[rng_.below(words.size())]);
    if (rng_.below(10) == 0) // from an earlier life
      perform(supervisor_.on_ended(who, 0, "", now_));
  }

  void end(std::size_t i) {
    auto& part = parts_[i];
    const auto life = *part.life;
    part.life.reset();
    if (supervisor_.phase_of(i) != phase::stopping)
      part.crashed = now_;
    perform(supervisor_.on_ended(i, life, "status 1", now_));
  }

  void write(std::size_t i, std::string_view word) {
    auto& part = parts_[i];
    if (word != "what" && !asked_to_end_) {
      const bool on = word == "on" || word == "start";
      if (on)
        part.off_since.reset();
      else {
        part.off_since = part.off_since.value_or(now_);
        part.crashed.reset();
      }
    }
    perform(supervisor_.on_request(i, word, now_));
  }

  void check() {
    for (std::size_t i = 0; i < count; ++i) {
      const auto& part = parts_[i];
      if (part.off_since && now_ - *part.off_since >= stop_time_max)
        REQUIRE(supervisor_.phase_of(i) == phase::off);
      if (supervisor_.phase_of(i) == phase::on)
        REQUIRE(part.life);
      if (supervisor_.phase_of(i) == phase::off)
        REQUIRE_FALSE(part.life);
    }
  }

  random_stream rng_;
  supervisor supervisor_;
  std::array<one, count> parts_;
  instant now_{};
  bool asked_to_end_ = false;
  bool over_ = false;
};

} // namespace

TEST_CASE("components never run twice, end when they are told to, and never come back too early",
          "[peisinit][SVC-01][SVC-04][SVC-05]") {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    CAPTURE(seed);
    random_host host(seed);
    host.run(instant(2min));
    host.shut_down();
  }
}
