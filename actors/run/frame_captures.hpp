// Captures of the islands' airs for Wireshark (ACT-07).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <variant>

#include "config/plan/ecology.hpp"
#include "io/files/pcap_file.hpp"
#include "io/files/pcapng.hpp"
#include "radio/channel/output.hpp"

namespace rubicon {

/// One file `island-ID.pcap` for each island in a folder, which is made if it is not there; with
/// lost frames `island-ID.pcapng`, where each of those has a comment that says why, from whom and
/// to whom.
class frame_captures {
public:
  /// @param with_lost frames that no radio received are written too
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
    struct seen {
      payload psdu;
      std::string comment; ///< empty: it was received
    };
    std::variant<io::pcap_file, io::pcapng_file> file;
    std::map<mote_id, std::string> names; ///< of the island's motes and its sink
    std::multimap<instant, seen> waiting; ///< by begin
    bool is_reported = false;             ///< that it failed

    void write_until(instant begin);
    void flush();
    [[nodiscard]] const std::string& error() const;
    [[nodiscard]] std::string comment_on(const radio::overheard& x) const;
    [[nodiscard]] std::string name_of(mote_id x) const;
  };

  [[nodiscard]] static capture made(const std::string& folder, const config::island_description& x,
                                    bool with_lost);

  static void report_failure(capture& x);

  std::map<std::uint16_t, capture> captures_; ///< by PAN
  bool with_lost_ = false;
};

} // namespace rubicon
