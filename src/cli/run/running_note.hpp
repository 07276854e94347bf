// A note of each run on this computer, by which commands find its network.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/plan/ecology.hpp"

namespace rubicon::cli {

/// A run of this user that accepts links.
struct running_ecology {
  std::string name;
  std::string network;
  std::vector<std::string> urls; ///< `tcp://127.0.0.1:8040`; none: its peers chose their ports
};

/// Records where the peers of a run in wall time accept links, while it lives. If it cannot be
/// written, commands need the address.
class running_note {
public:
  /// Writes nothing if no peer takes links.
  explicit running_note(const config::ecology_description& x);
  ~running_note();
  running_note(const running_note&) = delete;
  running_note& operator=(const running_note&) = delete;

private:
  std::string path_; ///< empty: there is none
};

/// By the notes of processes that are alive, at most `running_max`, in the order of their names.
[[nodiscard]] std::vector<running_ecology> running_ecologies();
inline constexpr std::size_t running_max = 64;

/// How the name of the note of a deployment ends, which is followed or was left by its coordinator.
inline constexpr const char* deployed_ending = ".deployed";

/// The deployments of this user, likewise; `urls` are those of their hosts.
[[nodiscard]] std::vector<running_ecology> deployed_ecologies();

} // namespace rubicon::cli
