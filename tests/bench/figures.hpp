// What a bench prints: figures, each beside its aim.
#pragma once

#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

namespace bench {

/// What a figure is to be.
struct aim {
  bool at_most = false; ///< else at least
  double value = 0;

  [[nodiscard]] bool met(double x) const { return at_most ? x <= value : x >= value; }
};
inline aim at_least(double x) {
  return {false, x};
}
inline aim at_most(double x) {
  return {true, x};
}

/// Prints figures as they come and remembers them.
class figures {
public:
  void section(const std::string& name, const std::string& what) {
    section_ = name;
    std::printf("\n%s: %s\n", name.c_str(), what.c_str());
    std::fflush(stdout);
  }

  void add(const std::string& what, double value, int digits, const std::string& unit,
           std::optional<aim> wanted = {}) {
    std::printf("  %-34s %12.*f %-8s", what.c_str(), digits, value, unit.c_str());
    if (wanted)
      std::printf("  aim %s %g: %s", wanted->at_most ? "<=" : ">=", wanted->value,
                  wanted->met(value) ? "met" : "missed");
    std::printf("\n");
    std::fflush(stdout);
    all_.push_back({section_, what, value, unit, wanted});
  }

  /// Remembers one that is printed otherwise, in a table for example.
  void keep(const std::string& what, double value, const std::string& unit) {
    all_.push_back({section_, what, value, unit, {}});
  }

  void failure(const std::string& what, const std::string& why) {
    std::printf("  %-34s FAILED: %s\n", what.c_str(), why.c_str());
    std::fflush(stdout);
    ++failures_;
  }

  [[nodiscard]] int failures() const { return failures_; }

  void print_json() const {
    std::printf("\n{\"failures\": %d, \"figures\": [\n", failures_);
    for (const auto& x : all_) {
      std::printf("  {\"section\": \"%s\", \"what\": \"%s\", \"unit\": \"%s\", \"value\": ",
                  x.section.c_str(), x.what.c_str(), x.unit.c_str());
      std::printf(std::isfinite(x.value) ? "%.6g" : "null", x.value);
      if (x.wanted)
        std::printf(", \"%s\": %g, \"met\": %s", x.wanted->at_most ? "at_most" : "at_least",
                    x.wanted->value, x.wanted->met(x.value) ? "true" : "false");
      std::printf("}%s\n", &x == &all_.back() ? "" : ",");
    }
    std::printf("]}\n");
  }

private:
  struct entry {
    std::string section;
    std::string what;
    double value = 0;
    std::string unit;
    std::optional<aim> wanted;
  };

  std::string section_;
  std::vector<entry> all_;
  int failures_ = 0;
};

} // namespace bench
