// What the parts of a report add up to over all lives of those who report them: a mote that crashed
// or a PC that was started again has counted twice, and neither count may get lost.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "apps/streams/stream_end.hpp"
#include "core/account/message_ledger.hpp"
#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "report/report.hpp"

namespace rubicon::report {

/// What a program reports of one end of a stream, in one life.
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

/// A program's counters over its lives.
struct program_counters {
  program_report sum;
  std::vector<std::pair<std::string, std::uint16_t>> read_ends; ///< keys of streams
};
RUBICON_FIELDS(program_counters, sum, read_ends);

/// A stream's counters over its lives.
struct stream_counters {
  /// One of its two programs.
  struct end {
    bool is_known = false;
    bool open = false;
    instant changed_at;                     ///< since when
    std::optional<instant> asked_at;        ///< when its program first began
    std::optional<instant> first_at;        ///< of the reader: when its first record came
    std::optional<std::uint32_t> newest_ms; ///< time in its newest record, its low 32 bits
    std::optional<instant> newest_at;       ///< of the reader: when that came
  };

  stream_report sum;
  end writer;
  end reader;
  duration every{};
};
RUBICON_FIELDS(stream_counters::end, is_known, open, changed_at, asked_at, first_at, newest_ms,
               newest_at);
RUBICON_FIELDS(stream_counters, sum, writer, reader, every);

/// The account of one sender's messages of one kind, as message_tally, where it may be incomplete:
/// other processes report what they have received.
struct sender_account {
  std::uint64_t sent = 0;
  std::uint64_t arrived = 0;
  std::uint64_t handed_over = 0; ///< to other processes
  std::uint64_t came_over = 0;   ///< of the messages of another process, those that arrived here
  cause_counts lost;
  std::uint64_t handed_lately = 0; ///< of handed_over: they may be on their way there
};
RUBICON_FIELDS(sender_account, sent, arrived, handed_over, came_over, lost, handed_lately);

/// What is counted before it is settled: parts of an ecology that ran in several processes add up.
struct unsettled_counters {
  using program_key = std::tuple<std::string, std::uint32_t, std::string>; ///< node, number, kind
  using stream_key = std::pair<std::string, std::uint16_t>;                ///< reader, number

  std::map<program_key, program_counters> programs;
  std::map<stream_key, stream_counters> streams;
  std::map<std::string, proxy_report> proxies;
  std::map<std::string, cause_counts> modules;     ///< by peer
  std::map<mote_address, message_report> messages; ///< of motes and gateways
  std::map<mote_address, message_report> pcs;
  using account_key = std::pair<mote_address, std::string>; ///< sender, kind of message
  std::map<account_key, sender_account> accounts;
  using loss_key = std::tuple<std::string, std::string, std::string>; ///< kind, cause, place
  std::map<loss_key, std::uint64_t> losses;
};
RUBICON_FIELDS(unsettled_counters, programs, streams, proxies, modules, messages, pcs, accounts,
               losses);

/// Of those messages, by cause.
[[nodiscard]] cause_counts lost_of(const message_tally& x);

/// All that was lost so far, by place.
[[nodiscard]] std::vector<loss_report> losses_of(const message_ledger& x);

class run_counters {
public:
  /// Messages of one life of a mote, gateway (no_mote) or PC.
  void add(mote_address who, bool is_pc, const message_report& x);

  /// All messages of this process so far; what was taken before gives way.
  void take(const message_ledger& x);

  /// One life of a program. @param number among those of its node; 0: it has one life only
  /// @param measured its figures that are no counts: those of its last life stand
  void add(const program_report& x, std::uint32_t number, const std::vector<std::string>& measured,
           const std::vector<stream_part>& streams);

  /// One life of a proxy. @param ended it is not the last, or there is none at the end
  void add(const proxy_report& x, bool ended);

  /// One life of a module of a gateway or PC.
  void add(const std::string& peer, const cause_counts& x);

  /// What another process has counted, of other things or of later lives of the same ones.
  /// @param begun when it began: its times are since then
  void add(const unsettled_counters& x, instant begun = {});

  /// All processes have reported: what was handed over to one of them and has not arrived there is
  /// lost, but for as many as may be on their way.
  void end_handed_over();

  /// Vectors that a program has missed in lives that are over.
  [[nodiscard]] std::uint64_t vectors_missed(const std::string& node, std::uint32_t number) const;

  /// In the order of their readers and numbers, whatever their age.
  [[nodiscard]] std::vector<half_open_stream> half_open(instant now) const;

  /// Fills in programs, streams, proxies, and messages of motes, islands and PCs.
  void settle(run_report& x) const;

  [[nodiscard]] const unsettled_counters& unsettled() const { return all_; }

private:
  [[nodiscard]] static stream_report settled(const stream_counters& x, instant now);
  [[nodiscard]] carried_report carried(const mote_address& who, message_kind kind) const;
  void settle_packets(run_report& x) const;
  void settle_streams(run_report& x) const;
  void settle_messages(run_report& x) const;

  unsettled_counters all_;
  std::uint32_t unnumbered_ = 0;
};

/// Takes back what settle() has filled in.
void unsettle(run_report& x);

} // namespace rubicon::report
