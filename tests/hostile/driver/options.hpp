// The command line of hostile_peer.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "hostile/attack.hpp"
#include "hostile/driver/player.hpp"

namespace rubicon::hostile {

struct options {
  std::vector<const attack_kind*> attacks;
  std::vector<std::size_t> links{1};
  play_config play;
  std::optional<pid_t> victim; ///< whose memory is watched
  bool loop = false;           ///< an honest peer is there, and is measured
  duration settle = 60s;       ///< at most, after each attack, until memory is back
  bool timed = true;           ///< how long the loop takes is judged, not only told
  bool check = false;          ///< what is beyond the limits is an error
  bool table = false;          ///< of Markdown, for the documents
};

inline constexpr const char* usage = R"(usage: hostile_peer --attack NAME,...|all [option...]
  --list             names the attacks
  --links N,...      how many links at a time (1); several: one play each
  --seconds S        how long each play lasts (1)
  --seed N           of all random numbers (1)
  --rate N           packages or so a second, over all links; 0: no limit (that of the attack)
  --port P           attacked, on 127.0.0.1 (8700)
  --network NAME     the network string (hostile)
  --hub ID, --keeper ID, --porch ID, --bystander ID    whom the attacks are about (30 31 32 40)
  --pid N            the process whose memory is watched
  --loop             an honest peer measures a control loop over hub and keeper, and a newcomer comes
  --settle S         how long to wait at most until memory is back after a play (60); less than a
                     minute: whether it is back is judged in the end only
  --untimed          how long the loop takes is told, but not judged: the machine may be busy
  --table            rows of a Markdown table, each to be ended by --report --table
  --check            exit status 1 if a limit was not kept
   or: hostile_peer --report FILE NAME [--table]    what the report of a run tells of that attack, or of `all`
)";

/// @returns what is wrong with the words, or the options
[[nodiscard]] std::optional<std::string> parse(const std::vector<std::string>& words, options& x);

} // namespace rubicon::hostile
