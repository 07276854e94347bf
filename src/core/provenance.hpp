// What led to what, for those who record a run: each thing that waits or travels keeps the number
// of what it came from. Simulation only, as the packet tags of ns-3: it is on no wire, in no
// comparison, in no trace, and no decision depends on it. Without a recorder all numbers are 0.
#pragma once

#include <cstdint>
#include <string_view>

namespace rubicon {

/// Who knows what is being handled at this moment, and gives numbers: an actor that is recorded.
class provenance_source {
public:
  provenance_source() = default;
  provenance_source(const provenance_source&) = delete;
  provenance_source& operator=(const provenance_source&) = delete;

  /// Of what is being handled; 0: nothing that has a number.
  [[nodiscard]] virtual std::uint64_t handled_number() const = 0;

  /// Of something new that what is being done now has led to. @param id tells it from its like
  [[nodiscard]] virtual std::uint64_t begin(std::string_view what, std::uint64_t id) = 0;

protected:
  virtual ~provenance_source() = default;
};

/// Where something came from. A member of this type, as it is made, keeps what was being done when
/// its owner was made.
class provenance {
public:
  provenance() : number_(now()) {}

  [[nodiscard]] static provenance none() { return provenance(0); }

  /// Of something that is followed by itself from here on, such as a message.
  [[nodiscard]] static provenance begin(std::string_view what, std::uint64_t id = 0);

  [[nodiscard]] std::uint64_t number() const { return number_; } ///< 0: from nothing known

  /// No part of any value.
  friend bool operator==(provenance, provenance) { return true; }

private:
  friend class acting_on;

  explicit provenance(std::uint64_t number) : number_(number) {}

  [[nodiscard]] static std::uint64_t now();

  std::uint64_t number_ = 0;
};

/// While this lives, what is made in this thread comes from `x`, whatever is being handled.
class acting_on {
public:
  explicit acting_on(provenance x);
  ~acting_on();
  acting_on(const acting_on&) = delete;
  acting_on& operator=(const acting_on&) = delete;

private:
  bool was_set_;
  std::uint64_t before_;
};

/// While this lives, its thread does what `who` handles; nullptr: nobody records.
class turn_of {
public:
  explicit turn_of(provenance_source* who);
  ~turn_of();
  turn_of(const turn_of&) = delete;
  turn_of& operator=(const turn_of&) = delete;

private:
  provenance_source* before_;
};

} // namespace rubicon
