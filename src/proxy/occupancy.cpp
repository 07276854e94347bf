#include <algorithm>
#include <map>

#include "core/text/decimal.hpp"
#include "proxy/classes/program.hpp"

namespace rubicon::proxy {

namespace {

constexpr std::string_view hold_setting = "hold_s";

/// nobody --a field above its threshold--> somebody --none for `hold`--> nobody
class occupancy final : public program {
public:
  occupancy(std::map<std::string, double> thresholds, duration hold)
      : thresholds_(std::move(thresholds)), hold_(hold) {}

  [[nodiscard]] std::vector<std::string> names() const override {
    return {"occupied", "occupied.by"};
  }

  [[nodiscard]] readings start(instant /*now*/) override { return current_state(); }

  [[nodiscard]] readings on_readings(const readings& x, instant now) override {
    for (const auto& each : x) {
      const auto threshold = thresholds_.find(each.name);
      const auto value = number_in(each.text);
      if (threshold == thresholds_.end() || !value || *value <= threshold->second)
        continue;
      until_ = now + hold_;
      if (!by_.empty())
        return {};
      by_ = each.name;
      return current_state();
    }
    return {};
  }

  [[nodiscard]] readings on_time(instant now) override {
    if (!until_ || *until_ > now)
      return {};
    until_.reset();
    by_.clear();
    return current_state();
  }

  [[nodiscard]] std::optional<instant> deadline() const override { return until_; }

private:
  [[nodiscard]] readings current_state() const {
    return {{"occupied.by", by_.empty() ? "none" : by_, ""},
            {"occupied", by_.empty() ? "no" : "yes", ""}};
  }

  std::map<std::string, double> thresholds_;
  duration hold_;
  std::string by_;               ///< empty: nobody is there
  std::optional<instant> until_; ///< unless somebody is noticed again
};

} // namespace

std::variant<program_factory, program_problem> make_occupancy(const proxy_class& what,
                                                              const program_settings& settings) {
  constexpr double hold_max_s = 86400;
  std::map<std::string, double> thresholds;
  duration hold = 60s;
  for (const auto& [name, value] : settings) {
    if (name == hold_setting) {
      if (value <= 0 || value > hold_max_s)
        return program_problem{name, "must be more than 0 and at most 86400"};
      hold = std::chrono::duration_cast<duration>(std::chrono::duration<double>(value));
      continue;
    }
    const auto of = std::ranges::find(what.fields, name, &field::name);
    if (of == what.fields.end())
      return program_problem{name, "is neither \"hold_s\" nor a field of the proxy"};
    if (!of->words.empty())
      return program_problem{name, "is a field with words, which cannot be compared with a number"};
    thresholds.emplace(name, value);
  }
  if (thresholds.empty())
    return program_problem{"", "needs a setting with the name of a field"};
  return program_factory(
      [thresholds, hold] { return std::make_unique<occupancy>(thresholds, hold); });
}

program_registry built_in_programs() {
  program_registry out;
  out.add("occupancy", make_occupancy);
  return out;
}

} // namespace rubicon::proxy
