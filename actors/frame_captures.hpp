// Captures of the islands' airs for Wireshark (ACT-07).
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "config/ecology.hpp"
#include "io/pcap_file.hpp"
#include "radio/channel.hpp"

namespace rubicon {

/// One file `island-ID.pcap` for each island in a folder, which is made if it is not there.
class frame_captures {
public:
  /// @param with_lost frames that nobody received are written too
  /// @throws std::runtime_error if the folder or a file cannot be made
  frame_captures(const std::string& folder, const config::ecology_description& ecology,
                 bool with_lost);

  /// Into the file of the sender's island.
  void write(const radio::overheard& x);

  /// @returns which files are not complete, and why; empty if all are
  [[nodiscard]] std::string finish();

private:
  /// The file of one island. Frames come when they end; one that began earlier may come later, by
  /// the length of the longest frame at most.
  struct capture {
    io::pcap_file file;
    std::multimap<instant, payload> waiting; ///< by begin
    bool is_told = false;                    ///< that it failed

    void write_until(instant begin);
  };

  static void tell_failure(capture& x);

  std::map<std::uint16_t, capture> captures_; ///< by PAN
  bool with_lost_ = false;
};

} // namespace rubicon
