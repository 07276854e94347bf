// For files of this room only: values of tuples, who sets them, who is notified of them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "explain/growth.hpp"
#include "peis/tuples/tuple.hpp"

namespace rubicon::explain {

/// A value begins with the request of a component that sets it, or, of a kernel's own, by itself
/// (`begun`, "value"): what is caused by that is about this value, whatever others it equals.
class tuple_follower {
public:
  explicit tuple_follower(growth& all) : all_(all) {}

  void on_set(const record& r, bool deleted);
  /// @returns what is to become of it
  [[nodiscard]] std::optional<sighting> on_set_remote(const record& r);
  void on_event(const record& r);

  /// @param x nothing: the package is a later part of a value
  [[nodiscard]] std::optional<sighting> recognise(const std::optional<peis::tuple>& x,
                                                  std::uint64_t cause, const record& r);

  /// A value that somebody else has asked for has come to its owner. @returns the step there
  node_index reach_owner(std::uint32_t index, const std::string& actor, node_index parent,
                         instant when);

private:
  std::uint32_t begin(tuple_value x, step how, std::uint64_t number, const record& r);

  growth& all_;
};

} // namespace rubicon::explain
