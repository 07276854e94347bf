// The source of what the report says of streams.
#pragma once

#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"

namespace rubicon::apps {

/// What a program knows of its end of a stream of sensor records, however often that was opened.
struct stream_end {
  std::uint16_t stream = 0;
  bool writes = false;
  mote_address reader;         ///< of a write end
  std::uint64_t records = 0;   ///< that the program had: written or not; that it has read
  std::uint64_t unwritten = 0; ///< of a write end: not taken
  std::uint64_t openings = 0;
  std::uint64_t opens_failed = 0;
  bool open = false;                    ///< now,
  instant changed_at;                   ///< and since when, by the node's clock
  std::optional<instant> started_at;    ///< when this life of the program began
  std::optional<instant> first_at;      ///< of a read end: when the first record of this life came,
  std::optional<instant> last_at;       ///< and the newest one, by the node's clock
  std::optional<std::uint32_t> last_ms; ///< time in the newest record, its low 32 bits
  duration every{};                     ///< between two of them
  duration pause{}; ///< of a read end: the longest without a record, since the first

  friend bool operator==(const stream_end&, const stream_end&) = default;
};
RUBICON_FIELDS(stream_end, stream, writes, reader, records, unwritten, openings, opens_failed, open,
               changed_at, started_at, first_at, last_at, last_ms, every, pause);

} // namespace rubicon::apps
