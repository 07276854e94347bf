// A frame that is alone on the air is dealt with at its end only, and there in short. The same
// steps with another frame on the air all the time, which nobody receives, have the same results.
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "radio/medium/filtered_frames.hpp"
#include "radio/medium/medium.hpp"
#include "support/catch.hpp"
#include "unit/radio/samples.hpp"

using namespace rubicon;
using namespace rubicon::radio;

namespace {

constexpr std::uint32_t motes = 4;
constexpr radio_index interferer{motes};
constexpr radio_index far_away{motes + 1};

/// Some motes, a source of noise, and a radio that nobody receives.
class field {
public:
  field(const channel_config& config, std::uint64_t seed, bool far_sends)
      : air_(config), errors_(config.curve), steps_(seed), luck_(seed + 1) {
    for (std::uint32_t i = 0; i <= far_away.value; ++i) {
      transceiver_config x;
      x.address = mote_id{static_cast<std::uint16_t>(i)};
      x.pan = 1;
      x.promiscuous = steps_.chance(0.2);
      x.sensitivity_dbm = -95;
      x.cca_dbm = -77;
      x.noise = to_units(-100);
      air_.add(std::move(x), energy_meter(find_platform("micaz"), 2000, 0, instant{}), instant{});
    }
    for (std::uint32_t from = 0; from <= interferer.value; ++from)
      around_.push_back(std::make_shared<const hearers>(links_of(from)));
    air_.switch_off(interferer, instant{});
    if (far_sends)
      static_cast<void>(air_.start(frame_of(far_away, 1h, frame_type::data, broadcast_mote),
                                   std::make_shared<const hearers>()));
  }

  [[nodiscard]] std::string run(int steps) {
    for (; steps > 0; --steps) {
      const auto next = now_ + steps_.between(20us, 600us);
      while (const auto first = first_end(next))
        end(*first);
      now_ = next;
      step(radio_index{static_cast<std::uint32_t>(steps_.below(motes))});
    }
    return log_.str();
  }

private:
  struct running {
    slot_index slot;
    instant ends;
  };

  /// From -97 dBm, which is too weak, over powers at which noise spoils some frames.
  hearers links_of(std::uint32_t from) {
    hearers all;
    for (std::uint32_t to = 0; to < motes; ++to) {
      if (to == from)
        continue;
      hearer x;
      x.radio = radio_index{to};
      x.power = static_cast<float>(to_units(-99.0 + static_cast<double>(steps_.below(30))));
      x.clean_damage =
          static_cast<float>(errors_.damage(double{x.power} / static_cast<double>(to_units(-100))));
      all.push_back(x);
    }
    return all;
  }

  [[nodiscard]] transmission frame_of(radio_index from, duration length, frame_type type,
                                      mote_id to) const {
    transmission x;
    x.from = from;
    x.content.type = type;
    x.content.pan = 1;
    x.content.destination = to;
    x.begin = now_;
    x.length = length;
    return x;
  }

  [[nodiscard]] std::optional<radio_index> first_end(instant until) const {
    std::optional<radio_index> first;
    for (std::uint32_t i = 0; i < motes; ++i)
      if (frames_[i] && frames_[i]->ends <= until &&
          (!first || frames_[i]->ends < frames_[first->value]->ends))
        first = radio_index{i};
    return first;
  }

  void end(radio_index from) {
    const auto x = *std::exchange(frames_[from.value], {});
    now_ = x.ends;
    std::array<outcome, motes> copies{}; // intact if not named
    const auto on_copy = [&](const transmission&, std::size_t place, const hearer& y, outcome z) {
      CHECK((*around_[from.value])[place] == y);
      copies[y.radio.value] = z;
    };
    const bool selective = steps_.chance(0.8) && air_.is_lone(x.slot);
    air_.end(x.slot, now_, luck_, on_copy, selective);
    for (const auto each : copies)
      log_ << static_cast<int>(each) << ' ';
    log_ << '\n';
  }

  void step(radio_index whose) {
    switch (steps_.below(8)) {
    case 0:
    case 1:
    case 2:
      return start(whose);
    case 3:
      return toggle(whose);
    case 4:
      if (steps_.chance(0.3))
        toggle_noise();
      return air_.await_ack(whose, steps_.chance(0.3));
    default:
      look_at(whose);
    }
  }

  void start(radio_index from) {
    if (is_off_[from.value] || frames_[from.value])
      return;
    const auto length = steps_.between(300us, 1500us);
    const auto type = steps_.chance(0.5) ? frame_type::data : frame_type::ack;
    const mote_id to{static_cast<std::uint16_t>(steps_.below(motes))};
    const auto slot = air_.start(frame_of(from, length, type, to), around_[from.value]);
    frames_[from.value] = running{slot, now_ + length};
  }

  void toggle(radio_index whose) {
    auto& is_off = is_off_[whose.value];
    if (is_off) {
      air_.switch_on(whose, now_);
    } else {
      if (auto& frame = frames_[whose.value]) {
        air_.cut(frame->slot);
        frame->ends = now_;
        end(whose);
      }
      air_.switch_off(whose, now_);
    }
    is_off = !is_off;
  }

  void toggle_noise() {
    if (is_noisy_)
      air_.end_noise(interferer, now_);
    else
      air_.start_noise(interferer, around_[interferer.value], now_);
    is_noisy_ = !is_noisy_;
  }

  void look_at(radio_index whose) {
    const auto times = air_.times(whose, now_);
    log_ << now_.time_since_epoch().count() << ' ' << whose.value << ' ' << air_.clear(whose, now_)
         << air_.receives(whose) << air_.was_busy(whose, now_ - timing::cca, now_) << ' '
         << times.radio_receive.count() << ' ' << times.radio_listen.count() << '\n';
  }

  medium air_;
  error_model errors_;
  random_stream steps_;
  random_stream luck_;
  instant now_{};
  std::vector<std::shared_ptr<const hearers>> around_;
  std::array<std::optional<running>, motes> frames_;
  std::array<bool, motes> is_off_{};
  bool is_noisy_ = false;
  std::ostringstream log_;
};

} // namespace

TEST_CASE("what becomes of a lone frame does not depend on frames that nobody receives",
          "[radio][medium][NET-15]") {
  channel_config config;
  config.propagation = GENERATE(propagation(log_distance{}), propagation(unit_disk{10}));
  config.collisions = GENERATE(collision_rule::strict, collision_rule::sinr);
  config.capture = GENERATE(false, true);
  config.sensing = GENERATE(sensing::carrier, sensing::energy, sensing::energy_or_carrier);
  config.window = GENERATE(sensing_window::end, sensing_window::whole);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    INFO("seed " << seed);
    const auto alone = field(config, seed, false).run(400);
    CHECK(alone.size() > 1000);
    CHECK(alone == field(config, seed, true).run(400));
  }
}

TEST_CASE("times of filtered frames are kept for so many senders, and taken out",
          "[radio][medium]") {
  filtered_frames x;
  std::vector<std::shared_ptr<const hearers>> lists;
  std::vector<std::uint32_t> places(128);
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    CHECK_FALSE(x.is_full());
    lists.push_back(std::make_shared<const hearers>(
        hearers{hearer{.radio = radio_index{i}}, hearer{.radio = radio_index{i + 1}}}));
    for (int frames = 0; frames < 2; ++frames)
      x.add(lists[i], places[i], 1ms, instant(i * 1ms));
  }
  CHECK(x.is_full());
  CHECK(x.received_by(radio_index{0}) == 2ms);
  CHECK(x.received_by(radio_index{1}) == 4ms);
  CHECK(x.last_end() == instant(127ms));
  CHECK(x.last_copy(radio_index{128}) != nullptr);
  CHECK(x.last_copy(radio_index{1}) == nullptr);
  std::vector<duration> times(129);
  x.take_out([&](radio_index radio, duration time) { times[radio.value] += time; });
  CHECK_FALSE(x.is_full());
  CHECK(times[0] == 2ms);
  CHECK(times[1] == 4ms);
  CHECK(times[128] == 2ms);
  CHECK(x.received_by(radio_index{1}) == duration{});
  x.add(lists[5], places[5], 1ms, instant(1s)); // its place is another's now, or nobody's
  x.add(lists[0], places[0], 1ms, instant(2s));
  CHECK(x.received_by(radio_index{5}) == 1ms);
  CHECK(x.received_by(radio_index{0}) == 1ms);
}
