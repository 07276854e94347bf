// An application: warns the gateway when it becomes cold, and says when that is over.
#pragma once

#include <array>
#include <memory>
#include <string>

#include <apps/application.hpp>

class frost_guard final : public rubicon::apps::application {
public:
  explicit frost_guard(const rubicon::apps::settings& x)
      : below_(x.get<double>("below")), every_(x.get<rubicon::duration>("every")) {}

  /// When on_time() is to be called next; nothing: never.
  std::optional<rubicon::instant> deadline() const override { return next_; }

  /// Asks for the temperature. Harmless before deadline().
  void on_time(rubicon::instant now) override {
    if (now < next_)
      return;
    next_ = now + every_;
    layer().read_transducers(std::array{rubicon::device::quantity::temperature});
  }

  /// The answer: in counts of 0.1 degrees.
  void transducersRead(std::span<const std::int16_t> counts, std::uint32_t) override {
    const bool cold = !counts.empty() && counts[0] < 10 * below_;
    if (cold == is_cold_)
      return;
    is_cold_ = cold;
    warnings_ += cold ? 1 : 0;
    notify(cold ? "frost!" : "it is warmer");
    const rubicon::bytes message{cold ? std::uint8_t{1} : std::uint8_t{0}};
    layer().send_numbered(rubicon::apps::own_gateway, message, true, 7); // reliably, on channel 7
  }

  /// What the report says of it.
  std::vector<rubicon::apps::figure> figures() const override {
    return {{"warnings", static_cast<double>(warnings_)}};
  }

private:
  void on_start(rubicon::instant now) override { next_ = now + every_; }

  double below_;
  rubicon::duration every_;
  rubicon::instant next_;
  bool is_cold_ = false;
  int warnings_ = 0;
};

/// How files name it, and what they may say: `{ app = "frost_guard", below = 3.5, every = "30s" }`.
inline rubicon::apps::application_kind frost_guard_kind() {
  using namespace std::chrono_literals;
  rubicon::apps::application_kind x;
  x.name = "frost_guard";
  x.keys = {{.name = "below",
             .otherwise = 0.0,
             .required = true,
             .min = -40,
             .max = 60,
             .meaning = "degrees below which it warns"},
            {.name = "every",
             .otherwise = rubicon::duration(10s),
             .meaning = "between two looks at the thermometer"}};
  x.make = [](const auto& settings, rubicon::random_stream) {
    return std::make_unique<frost_guard>(settings);
  };
  return x;
}
