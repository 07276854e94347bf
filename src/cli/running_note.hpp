// What runs on this computer leaves a note, so that commands that look into it find it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/ecology.hpp"

namespace rubicon::cli {

/// Where a run of this user can be entered.
struct running_ecology {
  std::string name;
  std::string network;
  std::vector<std::string> urls; ///< `tcp://127.0.0.1:8040`; none: its peers chose their ports
};

/// Says of a run in wall time where its peers take links, while it lives. A note that cannot be
/// written is none: who looks for it is told to say the place.
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

} // namespace rubicon::cli
