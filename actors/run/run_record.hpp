// The record of a run for `rubicon explain`.
#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>

#include "actors/run/run_source.hpp"
#include "config/plan/ecology.hpp"
#include "explain/record.hpp"
#include "radio/channel/output.hpp"
#include "report/history.hpp"
#include "scheduler/trace.hpp"

namespace rubicon {

/// Writes what has a part in the delivery of messages and tuples into one file
/// (explain/record.hpp): not timers, beacons, acks of frames, nor what PEIS kernels say to each
/// other about themselves.
class run_record {
public:
  /// Makes the file. @throws std::runtime_error if that fails
  /// @param octets_max it ends before it is longer, or there is no room: then it may be incomplete;
  /// 0: it is to be complete
  run_record(const std::string& path, const config::ecology_description& ecology,
             const run_source& source, std::uint64_t octets_max = 0);

  void write(const scheduler::delivery& x);
  void write(const scheduler::remark& x);
  void write(const message_end& x);
  void write(const radio::overheard& x);
  void write(const report::run_sample& x);

  /// @returns why the file is not complete; empty if it is
  [[nodiscard]] std::string finish();

private:
  void put(const explain::record& x);
  void put(const std::string& line);
  void check();
  void flush();
  void put_event(const scheduler::remark& x);
  void put_packages(explain::record r, byte_view octets);
  void note_sent(const explain::record& x);
  void note_received(const explain::record& x);
  [[nodiscard]] std::uint64_t recorded_cause(std::uint64_t number) const;

  std::string path_;
  std::ofstream file_;
  bool may_end_;
  std::uint64_t octets_left_; ///< that it may still get
  std::string error_;         ///< the first; nothing is written after it
  /// What a delivery that is not in the record was caused by; only ever looked up.
  std::unordered_map<std::uint64_t, std::uint64_t> left_out_;
  using package = std::pair<std::string, std::uint64_t>; ///< where, and its name
  struct numbers {
    std::uint64_t own = 0;
    std::uint64_t cause = 0;
  };
  std::map<package, numbers> sent_;          ///< and not come yet
  std::map<package, std::uint64_t> arrived_; ///< and not handled yet
  std::string last_story_; ///< that came as a message; the ecology remarks it once more
};

} // namespace rubicon
