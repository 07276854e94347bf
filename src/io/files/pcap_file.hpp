// A capture of an island's air for Wireshark and its kin.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>

#include "core/bytes.hpp"
#include "core/time.hpp"

namespace rubicon::io {

/// One pcap file of IEEE 802.15.4 frames with FCS (link type 195), times to the nanosecond.
///
/// What cannot be written is never passed over in silence: the first failure stays, nothing is
/// written after it, and error() returns it. Because frames are buffered, a full disk may show as
/// late as in flush(): who drops a file without it does not learn how it ended.
class pcap_file {
public:
  static constexpr std::size_t psdu_max = 127;

  /// Makes the file, or empties the one that is there.
  /// @param path in a folder that is there; `-` is a file of that name
  /// @returns the file, or why there is none: `a/b.pcap: No such file or directory`
  [[nodiscard]] static std::variant<pcap_file, std::string> open(const std::string& path);

  ~pcap_file();
  pcap_file(pcap_file&&) noexcept;
  pcap_file& operator=(pcap_file&&) noexcept;

  /// @param at ecology time, which the file shows as the time since 1970. @pre not before the start
  /// of the run
  /// @param psdu as on the air, FCS included. @pre at most psdu_max octets
  void write(instant at, byte_view psdu);

  /// Hands over to the system what is buffered.
  void flush();

  /// What went wrong first: `air.pcap: No space left on device`; empty while all is well.
  [[nodiscard]] const std::string& error() const;

  /// Frames taken before the first failure showed.
  [[nodiscard]] std::uint64_t frames() const;

private:
  struct impl;

  explicit pcap_file(std::unique_ptr<impl> x);

  std::unique_ptr<impl> impl_;
};

} // namespace rubicon::io
