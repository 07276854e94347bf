// Captures with words on frames: pcapng (draft-ietf-opsawg-pcapng), which libpcap reads and does
// not write. Octets of the three blocks that are needed, and a file of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "core/bytes.hpp"
#include "core/time.hpp"

namespace rubicon::io {

namespace pcapng {

inline constexpr std::uint16_t ieee802154_with_fcs = 195; ///< link type
inline constexpr std::size_t comment_octets_max = 1024;   ///< what is longer is cut

/// The block with which a file begins (section 4.1), in little-endian order. @param program that
/// writes it
[[nodiscard]] bytes section_header(std::string_view program);

/// The one interface of all frames (section 4.2), times in nanoseconds. @param name shown
[[nodiscard]] bytes interface_description(std::uint16_t link_type, std::uint32_t octets_max,
                                          std::string_view name);

/// A frame (section 4.3). @param comment UTF-8; empty: none
/// @pre at >= instant{}, which is shown as 1970
[[nodiscard]] bytes enhanced_packet(instant at, byte_view octets, std::string_view comment);

} // namespace pcapng

/// One file of IEEE 802.15.4 frames with FCS, some with a comment. Like pcap_file otherwise, its
/// words on failures included.
class pcapng_file {
public:
  static constexpr std::size_t psdu_max = 127;

  /// Makes the file, or empties the one that is there.
  /// @param name of the interface, as it is shown
  /// @returns the file, or why there is none: `a/b.pcapng: No such file or directory`
  [[nodiscard]] static std::variant<pcapng_file, std::string> open(const std::string& path,
                                                                   std::string_view name);

  ~pcapng_file();
  pcapng_file(pcapng_file&&) noexcept;
  pcapng_file& operator=(pcapng_file&&) noexcept;

  /// @pre as of pcap_file
  void write(instant at, byte_view psdu, std::string_view comment);
  void flush();

  /// What went wrong first; empty while all is well.
  [[nodiscard]] const std::string& error() const;

private:
  struct impl;

  explicit pcapng_file(std::unique_ptr<impl> x);

  std::unique_ptr<impl> impl_;
};

} // namespace rubicon::io
