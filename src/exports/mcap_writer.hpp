// A file in the format MCAP, version 0 (https://mcap.dev/spec).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "exports/octets_out.hpp"

namespace rubicon::exports {

struct mcap_schema {
  std::string_view name;
  std::string_view encoding; ///< `jsonschema`
  std::string_view text;
};

/// Messages in uncompressed chunks, each with its checksum and an index by time, and a summary at
/// the end. Keeps no more than one chunk, and what the summary says of each chunk.
class mcap_writer {
public:
  static constexpr std::size_t chunk_octets = 1U << 20U; ///< a chunk ends when it has as many

  using channel_id = std::uint16_t;

  explicit mcap_writer(octets_out out);

  /// @pre fewer than 65 535 before
  channel_id add_channel(std::string_view topic, const mcap_schema& schema);

  /// @pre `at` is not before the start of the run
  void add(channel_id to, instant at, std::string_view message);

  /// Nothing more comes.
  void finish();

private:
  using times_and_offsets = std::vector<std::pair<std::uint64_t, std::uint64_t>>;

  struct span {
    std::uint64_t first = 0; ///< ns
    std::uint64_t last = 0;
    std::uint64_t count = 0; ///< of messages

    void add(std::uint64_t at);
  };

  /// A chunk that is written.
  struct chunk_place {
    span times;
    std::uint64_t begin = 0;
    std::uint64_t octets = 0;
    std::map<channel_id, std::uint64_t> indices; ///< where they begin
    std::uint64_t index_octets = 0;
    std::uint64_t content_octets = 0;
  };

  void write(std::string_view octets);
  void end_chunk();
  void write_index(chunk_place& place);
  void write_summary();
  void write_offset(char code, std::uint64_t begin, std::string& offsets);
  [[nodiscard]] std::string statistics() const;

  octets_out out_;
  std::uint64_t written_ = 0; ///< octets
  std::uint32_t crc_ = 0;     ///< of these, or of those of the summary
  std::string chunk_;         ///< records
  span chunk_times_;
  std::map<channel_id, times_and_offsets> chunk_index_;
  std::vector<chunk_place> chunks_;
  span times_;
  std::string schemas_; ///< records
  std::string channels_;
  std::vector<std::uint64_t> counts_; ///< messages of each channel, from 1
};

/// Of ISO 3309, as zlib has it. @param before of the octets before
[[nodiscard]] std::uint32_t crc32(std::string_view octets, std::uint32_t before = 0);

} // namespace rubicon::exports
