// Reads the components of a host's init, from the file and from files in a folder (SVC-02).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/file_readers.hpp"

namespace rubicon::config {

/// A component, and the places of the keys that name its peer or command, and its id.
struct placed_component {
  peisinit::component what;
  mark at;
  mark what_at;
  mark id_at;
};

/// An init whose components are checked when all peers are known.
struct placed_init {
  peer_id peer;
  mark at;
  std::vector<placed_component> components;
  std::string folder; ///< empty: none
  mark folder_at;
};

/// app = "init" of the peer `own`; its components go into `placed`.
[[nodiscard]] init_app read_init(table_reader& in, surroundings& with, peer_id own,
                                 std::vector<placed_init>& placed);

/// Gives each init its components, and each peer that is a component its init. A file of a folder
/// that is not good is a warning.
void settle_inits(std::vector<placed_init> inits, std::vector<peer_description>& peers,
                  surroundings& with);

} // namespace rubicon::config
