// The peer that a bridge belongs to, for the readers of bridges.
#pragma once

#include <optional>
#include <string>

#include "config/file_readers.hpp"

namespace rubicon::config {

/// A peer of the file, not a gateway.
struct bridge_peer {
  using type = std::string;

  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who);
  [[nodiscard]] static form takes() { return string_form("name of a peer"); }
};

/// Adds a bridge to the apps of a peer that the file has; else does nothing.
void add_bridge(ecology_description& out, const std::string& peer, peer_app bridge);

} // namespace rubicon::config
