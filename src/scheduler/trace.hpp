// The trace of a run: every message delivered to a traced actor, folded into 64 bits, so that two
// runs can be compared by one number (GEN-07, ACT-05).
#pragma once

#include <any>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <caf/actor_clock.hpp>

#include "core/account/message_ledger.hpp"
#include "core/account/provenance.hpp"
#include "core/bytes.hpp"
#include "core/hash.hpp"
#include "core/time.hpp"
#include "scheduler/messages/envelope.hpp"

namespace rubicon::scheduler {

/// One message as it enters the mailbox of an actor.
struct delivery {
  instant time;             ///< ecology time of the enqueue
  std::string_view path;    ///< receiver; valid during the call only
  std::string_view sender;  ///< empty for none and for actors without a path
  const envelope& message;  ///< `message.text()` shows it
  std::uint64_t number = 0; ///< ascending, from 1, as those of remarks that begin something; 0
                            ///< unless remarks are observed too
  std::uint64_t cause =
      0; ///< number of what led to it (core/account/provenance.hpp); 0: nothing known
  bool received = true; ///< false: the receiver has ended

  /// The message, if it is a `Message`; nullptr: it is not.
  template <class Message>
  [[nodiscard]] const Message* as() const {
    return message.as<Message>();
  }
};

/// Something an actor has noticed that no message carries, such as octets that are lost. It is for
/// observers only and never part of the trace.
struct remark {
  instant time;
  std::string_view path;    ///< whose; valid during the call only, like the next
  std::string_view what;    ///< its kind
  std::uint64_t id = 0;     ///< of what it is about
  byte_view octets;         ///< that it is about
  std::uint64_t cause = 0;  ///< as in delivery
  std::any content = {};    ///< instead of octets
  std::uint64_t number = 0; ///< of what begins here (provenance::begin); 0: nothing does
};

class process;
/// What one logical process has folded. Each actor folds what it is delivered, in that order, with
/// the time of each; what all have folded is added up. So the sum is the same whoever runs first
/// among those that send each other nothing, and an island that is added adds to it.
class trace_part {
public:
  [[nodiscard]] std::uint64_t sum() const { return sum_; }
  [[nodiscard]] std::uint64_t events() const { return events_; }

  /// @param of the receiver, so far; the new value
  void fold(std::uint64_t& of, instant time, const envelope& message);

private:
  std::uint64_t sum_ = 0;
  std::uint64_t events_ = 0;
};

/// Folds deliveries: receiver's path, ecology time, the name of the message's type and its content.
///
/// Never folded: senders, handles inside messages, and the content of what CAF sends, because that
/// names actors by numbers that CAF made up.
class trace_recorder {
public:
  using observer = std::function<void(const delivery&)>;
  using remark_observer = std::function<void(const remark&)>;

  /// @param clock of the ecology time; must outlive the last delivery
  void start(const caf::actor_clock& clock) { clock_ = &clock; }

  /// Nothing is recorded any more.
  void stop() { clock_ = nullptr; }

  /// Called for every delivery from now on, after it is folded; for debugging. Must not send. From
  /// now on events happen in the order of their time, one after the other.
  void observe(observer x) { observer_ = std::move(x); }

  /// Called for every delivery to an actor whose path begins with `paths`, by any thread that
  /// executes events, and not in the order of their time. The sender is not given. Must not
  /// send. @pre no such actor has its place yet
  void watch(std::string paths, observer x) {
    watched_paths_ = std::move(paths);
    watcher_ = std::move(x);
  }
  [[nodiscard]] bool watches(std::string_view path) const {
    return watcher_ && path.starts_with(watched_paths_);
  }

  /// As observe(), for remarks. From now on it is known what led to what.
  void observe_remarks(remark_observer x) { remark_observer_ = std::move(x); }
  [[nodiscard]] bool wants_remarks() const { return static_cast<bool>(remark_observer_); }

  /// For one more process. Lives as long as the recorder.
  [[nodiscard]] trace_part& add_part() {
    return *parts_.emplace_back(std::make_unique<trace_part>());
  }

  /// Nothing: nothing is recorded.
  [[nodiscard]] std::optional<instant> now() const;

  /// Notifies observers of a message that is folded. Called once for each, which gets its number.
  /// @param from empty: no actor, or one without a path
  /// @param received whether the receiver still lives
  /// @param is_watched whether watches() of the receiver's path `to`
  void notify(instant time, std::string_view to, std::string_view from, envelope& x, bool received,
              bool is_watched);

  /// Whether somebody sees events, and wants to in the order of their time.
  [[nodiscard]] bool is_observed() const { return observer_ || remark_observer_; }

  void note(remark x);

  /// Gives a number to what `path` begins, and reports it to observers. @pre wants_remarks()
  [[nodiscard]] std::uint64_t begin(std::string_view path, std::string_view what, std::uint64_t id);

  /// The account of all messages of the run.
  [[nodiscard]] message_ledger& messages() { return *messages_; }

  /// The trace so far: equal for equal runs, on any machine.
  [[nodiscard]] std::uint64_t hash() const;

  /// Deliveries so far.
  [[nodiscard]] std::uint64_t events() const;

private:
  const caf::actor_clock* clock_ = nullptr; ///< nullptr: nothing is recorded
  std::shared_ptr<message_ledger> messages_ = message_ledger::make();
  std::vector<std::unique_ptr<trace_part>> parts_;
  std::uint64_t numbers_given_ = 0;
  observer observer_;
  std::string watched_paths_;
  observer watcher_;
  remark_observer remark_observer_;
};

/// Whose events this thread executes; nullptr: nobody's. For process.hpp.
inline constinit thread_local process* executed_process = nullptr; // NOLINT

/// What a traced actor knows about itself.
class traced_base : public provenance_source {
public:
  /// Where the actor stands in the ecology, such as `island/7/mote/12`; empty if it was never
  /// placed.
  [[nodiscard]] const std::string& path() const;

  /// Gives the actor its path, its process and its recorder. Must happen right after the spawn,
  /// before anything runs; the spawn helpers in spawn.hpp and world.hpp do it.
  void place(std::string path, process& where, trace_recorder* recorder);

  /// A number made of the path.
  [[nodiscard]] std::uint64_t path_hash() const { return path_hash_; }

  /// nullptr if it was never placed.
  [[nodiscard]] process* where() const { return process_; }

  [[nodiscard]] std::uint64_t begin(std::string_view what, std::uint64_t id) override {
    return recorder_ != nullptr && recorder_->wants_remarks() ? recorder_->begin(path(), what, id)
                                                              : 0;
  }
  [[nodiscard]] message_ledger* ledger() override {
    return recorder_ != nullptr ? &recorder_->messages() : nullptr;
  }
  [[nodiscard]] std::string_view place() const override { return path(); }
  [[nodiscard]] instant time() const override;

  /// Notifies observers; costs nothing without any.
  /// @param octets made only if somebody observes
  template <class Octets>
  void remark(std::string_view what, std::uint64_t id, Octets octets) const {
    if (recorder_ != nullptr && recorder_->wants_remarks()) {
      const auto content = octets();
      recorder_->note({{}, path(), what, id, content});
    }
  }

  /// The same of what is not octets. @param make returns a std::any
  template <class Make>
  void remark_any(std::string_view what, Make make) const {
    if (recorder_ != nullptr && recorder_->wants_remarks())
      recorder_->note({{}, path(), what, 0, {}, 0, make()});
  }

protected:
  traced_base() = default;
  ~traced_base() override = default;

  /// Itself, if it was placed.
  [[nodiscard]] provenance_source* source() { return recorder_ != nullptr ? this : nullptr; }

  /// Once for each message to this actor.
  /// @param from nullptr: no actor
  /// @param received whether this actor still lives
  void record(envelope& x, const traced_base* from, bool received);

  /// While this lives, what is sent comes from that actor.
  class turn {
  public:
    explicit turn(traced_base& whose);
    ~turn();
    turn(const turn&) = delete;
    turn& operator=(const turn&) = delete;

  private:
    process* process_;
    traced_base* before_ = nullptr;
  };

private:
  [[nodiscard]] trace_part& part() const;

  const std::string* path_ = nullptr;     ///< in the account of messages, or else its own
  std::unique_ptr<std::string> own_path_; ///< without a recorder
  std::uint64_t path_hash_ = 0;
  std::uint64_t fold_ = 0; ///< of what it was delivered
  process* process_ = nullptr;
  trace_recorder* recorder_ = nullptr;
  bool is_watched_ = false; ///< somebody sees what it is delivered
};

} // namespace rubicon::scheduler
