// What the parts of a report add up to over all lives of those who tell them: a mote that crashed
// or a PC that was started again has counted twice, and neither count may get lost.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "apps/stream_end.hpp"
#include "core/address.hpp"
#include "core/time.hpp"
#include "report/report.hpp"

namespace rubicon::report {

/// What a program tells of one end of a stream, in one life.
struct stream_part : apps::stream_end {
  std::string writer_name; ///< node; empty for a read end
  std::string reader_name; ///< node
};

/// A stream of which only one end has been open for a while.
struct half_open_stream {
  std::uint16_t stream = 0;
  std::string open_at; ///< node
  std::string closed_at;
  duration steady{};
};

class run_counters {
public:
  using arrival_counts = std::vector<std::pair<mote_address, std::uint64_t>>;

  /// Messages of one life of a mote, gateway (no_mote) or PC.
  /// @param arrivals unreliable messages that have come to it, by source
  void add(mote_address who, bool is_pc, const message_report& x, const arrival_counts& arrivals);

  /// One life of a program. @param number among those of its node; 0: it has one life only
  /// @param measured its figures that are no counts: those of its last life stand
  void add(const program_report& x, std::uint32_t number, const std::vector<std::string>& measured,
           const std::vector<stream_part>& streams);

  /// One life of a proxy. @param ended it is not the last, or there is none at the end
  void add(const proxy_report& x, bool ended);

  /// Vectors that a program has missed in lives that are over.
  [[nodiscard]] std::uint64_t vectors_missed(const std::string& node, std::uint32_t number) const;

  /// In the order of their readers and numbers, whatever their age.
  [[nodiscard]] std::vector<half_open_stream> half_open() const;

  /// Fills in programs, streams, proxies, and messages of motes, islands and PCs.
  void settle(run_report& x) const;

private:
  struct program_counters {
    program_report sum;
    std::vector<std::pair<std::string, std::uint16_t>> read_ends; ///< keys of streams
  };

  struct stream_counters {
    stream_report sum;
    std::optional<std::uint32_t> written_ms; ///< time in the newest record of each end
    std::optional<std::uint32_t> read_ms;
    duration every{};
    bool has_ends[2] = {false, false}; ///< writer and reader; the next ones too
    bool open[2] = {false, false};
    duration steady[2] = {};
  };

  [[nodiscard]] static stream_report settled(const stream_counters& x);
  void settle_streams(run_report& x) const;
  void settle_messages(run_report& x) const;

  std::map<std::tuple<std::string, std::uint32_t, std::string>, program_counters> programs_;
  std::map<std::pair<std::string, std::uint16_t>, stream_counters> streams_;
  std::map<std::string, proxy_report> proxies_;
  std::map<mote_address, message_report> messages_; ///< of motes and gateways
  std::map<mote_address, message_report> pcs_;
  std::map<mote_address, std::uint64_t> arrivals_; ///< by source
  std::uint32_t unnumbered_ = 0;
};

} // namespace rubicon::report
