// Which of the interfaces that perceive an object its proxy listens to (D1.1 3.2.2; PXY-07).
#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/address.hpp"

namespace rubicon::proxy {

/// An interface, by its owner's PEIS id and its name.
struct interface_id {
  peer_id owner;
  std::string name;

  friend bool operator==(const interface_id&, const interface_id&) = default;
  friend auto operator<=>(const interface_id&, const interface_id&) = default;
};

/// The strongest one, with hysteresis: another must be stronger by so much while ours still
/// perceives the object.
class interface_choice {
public:
  explicit interface_choice(double hysteresis_db = 4) : hysteresis_db_(hysteresis_db) {}

  /// @returns whether the choice is another now
  bool on_percept(const interface_id& from, double rssi_dbm) {
    perceived_[from] = rssi_dbm;
    return choose();
  }
  bool on_gone(const interface_id& from) {
    perceived_.erase(from);
    return choose();
  }

  /// Nothing: none perceives it.
  [[nodiscard]] const std::optional<interface_id>& chosen() const { return chosen_; }

private:
  bool choose() {
    const auto ours = chosen_ ? perceived_.find(*chosen_) : perceived_.end();
    auto best = ours;
    for (auto x = perceived_.begin(); x != perceived_.end(); ++x) {
      const auto needed = best == perceived_.end() ? x->second
                          : best == ours           ? ours->second + hysteresis_db_
                                                   : best->second;
      if (best == perceived_.end() || x->second > needed)
        best = x;
    }
    const auto next = best == perceived_.end() ? std::nullopt : std::optional(best->first);
    if (next == chosen_)
      return false;
    chosen_ = next;
    return true;
  }

  double hysteresis_db_;
  std::map<interface_id, double> perceived_;
  std::optional<interface_id> chosen_;
};

} // namespace rubicon::proxy
