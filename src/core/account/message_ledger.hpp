// The one account of messages. Each message that a program offers and its layer takes is opened
// once, and ends in exactly one outcome: it has arrived, it is lost for a cause at a place, or it
// has left for another process. Until then it is in transit. Report, explain, CSV files, page and
// expectations read this account.
//
// Every copy of a message holds its account through `provenance`. A receiver notes the arrival, who
// drops a copy notes why; when no copy is left, the newest note is the message's outcome. So the
// account is as large as what is in transit.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/account/loss.hpp"
#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/small_map.hpp"
#include "core/time.hpp"

namespace rubicon {

enum class message_kind : std::uint8_t {
  message, ///< connectionless, reliable or not
  channel, ///< a packet of a stream or a synaptic channel, over a channel of its island's Network
  tunnel,  ///< the same to or from another island or a PC
};

/// `message`
[[nodiscard]] std::string_view to_string(message_kind x);

/// What became of the messages of one sender. sent = arrived + sum of lost + handed_over +
/// in_transit().
struct message_tally {
  std::uint64_t sent = 0;
  std::uint64_t arrived = 0;
  std::uint64_t handed_over = 0;       ///< to another process, which says whether they arrived
  std::uint64_t handed_lately = 0;     ///< of these: they may be on their way there
  small_map<loss, std::uint64_t> lost; ///< by cause

  [[nodiscard]] std::uint64_t lost_in_all() const;
  [[nodiscard]] std::uint64_t in_transit() const {
    return sent - arrived - handed_over - lost_in_all();
  }
};

/// How it ended with one.
struct message_end {
  enum class how : std::uint8_t { arrived, lost, handed_over };

  std::uint64_t number = 0; ///< of its begin (provenance)
  message_kind kind = message_kind::message;
  mote_address source;
  mote_address destination;
  how outcome = how::lost;
  loss cause = loss::unknown; ///< if it is lost
  std::string_view place;     ///< where that was, an actor path of its ledger; or where it arrived
  instant at;
};

/// Why a copy of a message went no further, when and where.
struct loss_note {
  loss why = loss::unknown;
  instant at;
  std::string_view place; ///< an actor path of the ledger
};

class message_account;

/// Shared by all threads that execute a run.
class message_ledger : public std::enable_shared_from_this<message_ledger> {
public:
  using sender = std::pair<mote_address, message_kind>;
  using tallies = std::map<sender, message_tally>;
  using places = std::map<std::tuple<message_kind, loss, std::string>, std::uint64_t>;

  static constexpr std::size_t places_max = 4096; ///< further ones have no name
  /// A package of a PEIS link that has not come after so long is lost.
  static constexpr duration package_lifetime = 60s;
  static constexpr std::size_t packages_max = 65536; ///< on links; older ones count as lost
  /// In another process a message arrives within so long, or not at all.
  static constexpr duration way_elsewhere = 60s;
  static constexpr std::size_t lately_max = 65536; ///< older ones have arrived, or never will

  [[nodiscard]] static std::shared_ptr<message_ledger> make();

  /// For benchmarks of what accounts cost: messages that begin from now on, in any run of this
  /// process, have one or not. Not while a run is in progress.
  static void give_accounts(bool x);

  /// Called for each end, by any thread; must outlive the run, and must not send.
  void observe(std::function<void(const message_end&)> observer) {
    observer_ = std::move(observer);
  }

  /// One text for all who have this path, as long as the ledger lives.
  [[nodiscard]] const std::string& path(const std::string& x);

  // -- what the free functions below do

  [[nodiscard]] account_ref open(std::uint64_t number, message_kind kind, mote_address source,
                                 mote_address destination);
  void cancel(message_account& x);
  void note_loss(message_account& x, loss why);
  void note_arrival(message_account& x);
  void end(message_account& x); ///< no copy of it is left
  void note_foreign_arrival(mote_address source, message_kind kind);

  // -- packages of PEIS links, which travel as octets

  /// @param leaves on a link to another process, or one that we do not see
  void depart(std::uint64_t package, bool leaves);
  /// Nothing if it is no copy of a message of this process.
  [[nodiscard]] account_ref come(std::uint64_t package);
  void package_lost(std::uint64_t package);

  /// The run is over: what is destroyed from now on stays in transit.
  void finish();

  // -- what it says

  [[nodiscard]] tallies tallied() const;
  /// Without handed_lately.
  [[nodiscard]] message_tally of(mote_address source, message_kind kind) const;
  [[nodiscard]] places lost_at() const;
  /// Messages of other processes that have arrived in this one, by sender.
  [[nodiscard]] std::map<sender, std::uint64_t> foreign_arrivals() const;

private:
  /// On a link.
  struct package {
    std::uint64_t name = 0;
    account_ref account;
    loss_note if_lost;
  };
  using packages = std::list<package>;

  message_ledger() = default;
  void notify(const message_end& x);
  void remove(packages::iterator which, packages& to);
  void remove(std::uint64_t name, packages& to);
  void expire(instant now, packages& to);
  void note_handed_over(const message_end& x);
  [[nodiscard]] std::unique_lock<std::mutex> locked() const;

  struct sender_hash {
    std::size_t operator()(const sender& x) const noexcept {
      return std::size_t{x.first.island.value} << 24U | std::size_t{x.first.mote.value} << 8U |
             static_cast<std::size_t>(x.second);
    }
  };

  mutable std::mutex mutex_;
  std::unordered_set<std::string> paths_;
  std::unordered_map<sender, message_tally, sender_hash> tallies_;
  std::map<std::tuple<message_kind, loss, std::string_view>, std::uint64_t> places_; ///< of paths_
  std::map<sender, std::uint64_t> foreign_;
  packages packages_; ///< as they departed
  std::unordered_map<std::uint64_t, packages::iterator> by_name_;
  std::deque<std::pair<instant, sender>> handed_; ///< what was handed over, and when
  bool finished_ = false;
  std::function<void(const message_end&)> observer_;
};

/// Of one message, until no copy of it is left: counts in its sender's tally how it ends. Its
/// ledger calls it, under its lock.
///
///   open --note_arrival()--> ended (arrived)     open --end()--> ended (lost or handed over)
///   open --cancel()--> cancelled
class message_account : public copy_count {
public:
  message_account(std::shared_ptr<message_ledger> in, message_tally& tally,
                  const message_end& about)
      : in_(std::move(in)), tally_(tally), about_(about) {}

  [[nodiscard]] mote_address source() const { return about_.source; }
  [[nodiscard]] message_kind kind() const { return about_.kind; }
  [[nodiscard]] message_ledger& ledger() const { return *in_; }
  [[nodiscard]] bool is_open() const { return state_ == state::open; }
  [[nodiscard]] const message_end& about() const { return about_; } ///< with the newest note

  /// It travels on a link to another process, or one that we do not see.
  void set_leaves(bool x) { leaves_ = x; }
  [[nodiscard]] bool leaves() const { return leaves_; }

  void cancel(); ///< it counts as not sent
  void note_loss(const loss_note& x);
  /// @returns false: it was not open, and nothing was done
  [[nodiscard]] bool note_arrival(std::string_view place, instant at);
  /// No copy is left. @param place, at of the last one: they stand if no loss was noted before
  /// @param stops who held it is being destroyed, which is the cause then
  /// @pre is_open()
  void end(std::string_view place, instant at, bool stops);

private:
  enum class state : std::uint8_t { open, cancelled, ended };

  std::shared_ptr<message_ledger> in_;
  message_tally& tally_; ///< of its sender, in there
  message_end about_;
  state state_ = state::open;
  bool leaves_ = false;
};

/// What is offered now is a message. @returns for acting_on while it is handed on
[[nodiscard]] provenance begin_message(message_kind kind, mote_address source,
                                       mote_address destination);

/// Its sender's layer refuses the message that is being offered: it is not sent.
void refuse_message();

/// A copy of the message that is being handled goes no further.
void note_loss(loss why);

/// The same of one that has waited.
void note_loss(const provenance& of, loss why);

/// The message that is being handled has reached its destination.
/// @param source as its octets say, since what a message has led to is no copy of it; not known of
/// channels
void note_arrival(message_kind kind, std::optional<mote_address> source);

/// A package of a PEIS link that holds a copy of what is handled leaves as octets, or comes.
/// @param name peis::name_of()
/// @param leaves on a link to another process, or one that we do not see
void package_departs(std::uint64_t name, bool leaves);
[[nodiscard]] provenance package_comes(std::uint64_t name);

} // namespace rubicon
