// The trace of a run: every message delivered to a traced actor, folded into 64 bits, so that two
// runs can be compared by one number (GEN-07, ACT-05).
#pragma once

#include <any>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <typeinfo>
#include <unordered_map>
#include <utility>
#include <vector>

#include <caf/actor_clock.hpp>
#include <caf/event_based_actor.hpp>
#include <caf/mailbox_element.hpp>
#include <caf/meta/type_name.hpp>
#include <caf/stateful_actor.hpp>
#include <caf/type_erased_tuple.hpp>
#include <caf/typed_event_based_actor.hpp>

#include "core/bytes.hpp"
#include "core/hash.hpp"
#include "core/provenance.hpp"
#include "core/time.hpp"

namespace rubicon::scheduler {

/// One message as it enters the mailbox of a traced actor.
struct delivery {
  instant time;                          ///< ecology time of the enqueue
  std::string_view path;                 ///< receiver; valid during the call only
  std::string_view sender;               ///< empty for none and for actors without a path
  const caf::type_erased_tuple& content; ///< `content.stringify()` shows it
  std::uint64_t number = 0;              ///< ascending, from 1, as those of remarks that begin
                                         ///< something; 0 unless remarks are observed too
  std::uint64_t cause = 0; ///< number of what led to it (core/provenance.hpp); 0: nothing known
  bool heard = true;       ///< false: the receiver has ended

  /// The message, if it is a T and nothing else; nullptr: it is not. Costs far less than CAF's own
  /// matching, which compares names of types.
  template <class T>
  [[nodiscard]] const T* only() const {
    return content.size() == 1 && content.type(0).second == &typeid(T) ? &content.get_as<T>(0)
                                                                       : nullptr;
  }
};

/// Something an actor has noticed that no message tells, such as octets that are lost. It is for
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
class traced_base;

/// What one logical process has folded. Each actor folds what it is delivered, in that order, with
/// the time of each; what all have folded is added up. So the sum is the same whoever runs first
/// among those that do not hear of each other, and an island that is added adds to it.
class trace_part {
public:
  [[nodiscard]] std::uint64_t sum() const { return sum_; }
  [[nodiscard]] std::uint64_t events() const { return events_; }

  /// @param of the receiver, so far; the new value
  void fold(std::uint64_t& of, instant time, const caf::type_erased_tuple& content);

private:
  struct type_entry {
    std::uint64_t hash = 0;
    bool opaque = false; ///< only the type's name is folded
  };

  void fold(fold64& into, const caf::type_erased_tuple& content);
  [[nodiscard]] type_entry entry_of(caf::rtti_pair type);
  [[nodiscard]] type_entry entry_of_number(std::uint16_t number);

  std::uint64_t sum_ = 0;
  std::uint64_t events_ = 0;
  std::vector<type_entry> numbered_types_;
  std::unordered_map<const std::type_info*, type_entry> named_types_;
  const std::type_info* last_type_ = nullptr;
  type_entry last_entry_;
};

/// Folds deliveries: receiver's path, ecology time, types and content.
///
/// Content is folded as CAF would serialize it. Never folded: senders, request ids, and the content
/// of what names actors, because CAF numbers those by chance of history: exit_msg, down_msg,
/// timeout_msg and other system messages, and handles that are a message element of their own. A
/// handle inside a struct must be wrapped in `carried`.
class trace_recorder {
public:
  using observer = std::function<void(const delivery&)>;
  using remark_observer = std::function<void(const remark&)>;

  /// @param clock tells the ecology time; must outlive the last delivery
  /// @param shared whether several threads deliver, as they may in wall time; if not, only what the
  ///               calling thread delivers is recorded
  void start(const caf::actor_clock& clock, bool shared);

  /// Nothing is recorded any more.
  void stop();

  /// Called for every delivery from now on, after it is folded; for debugging. Must not send. From
  /// now on events happen in the order of their time, one after the other.
  void observe(observer x) { observer_ = std::move(x); }

  /// Called for every delivery to an actor whose path begins with `paths`, by any thread that
  /// executes events, and not in the order of their time. It is not told who the sender is. Must
  /// not send. @pre no such actor has its place yet
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

  /// @param part of the process of `to`
  /// @param heard whether the receiver still lives
  void record(trace_part& part, traced_base& to, const caf::mailbox_element& x, bool heard);

  /// Whether somebody sees events, and wants to in the order of their time.
  [[nodiscard]] bool is_observed() const { return observer_ || remark_observer_; }

  void note(remark x);

  /// Gives a number to what `path` begins, and tells it. @pre wants_remarks()
  [[nodiscard]] std::uint64_t begin(std::string_view path, std::string_view what, std::uint64_t id);

  /// Of a delivery that is being handled; 0: none, or nothing is.
  [[nodiscard]] std::uint64_t number_of(const caf::mailbox_element* x) const;

  /// The trace so far: equal for equal runs, on any machine.
  [[nodiscard]] std::uint64_t hash() const;

  /// Deliveries so far.
  [[nodiscard]] std::uint64_t events() const;

private:
  [[nodiscard]] std::unique_lock<std::mutex> guard() const;

  const caf::actor_clock* clock_ = nullptr; ///< nullptr: nothing is recorded
  bool shared_ = false;
  std::thread::id home_;
  mutable std::mutex mutex_; ///< guards everything if shared_
  std::vector<std::unique_ptr<trace_part>> parts_;
  std::uint64_t numbers_given_ = 0;
  observer observer_;
  std::string watched_paths_;
  observer watcher_;
  remark_observer remark_observer_;
  /// The newest delivery at each address that a mailbox element has had; kept for an observer only,
  /// and only ever looked up.
  std::unordered_map<const caf::mailbox_element*, std::uint64_t> numbers_;
};

/// Whose events this thread executes; nullptr: nobody's. For process.hpp.
inline constinit thread_local process* executed_process = nullptr; // NOLINT

/// What a traced actor knows about itself.
class traced_base : public provenance_source {
public:
  /// Where the actor stands in the ecology, such as `island/7/mote/12`; empty if it was never
  /// placed.
  [[nodiscard]] const std::string& path() const { return path_; }

  /// Gives the actor its path, its process and its recorder. Must happen right after the spawn,
  /// before anything runs; the spawn helpers in spawn.hpp and world.hpp do it.
  void place(std::string path, process& where, trace_recorder* recorder);

  /// A number made of the path.
  [[nodiscard]] std::uint64_t path_hash() const { return path_hash_; }

  /// nullptr if it was never placed.
  [[nodiscard]] process* where() const { return process_; }

  [[nodiscard]] std::uint64_t handled_number() const override {
    return recorder_->number_of(handled());
  }
  [[nodiscard]] std::uint64_t begin(std::string_view what, std::uint64_t id) override {
    return recorder_->begin(path_, what, id);
  }

  /// Tells observers; costs nothing without any.
  /// @param octets made only if somebody observes
  template <class Octets>
  void remark(std::string_view what, std::uint64_t id, Octets octets) const {
    if (recorder_ != nullptr && recorder_->wants_remarks()) {
      const auto content = octets();
      recorder_->note({{}, path_, what, id, content});
    }
  }

  /// The same of what is not octets. @param make returns a std::any
  template <class Make>
  void remark_any(std::string_view what, Make make) const {
    if (recorder_ != nullptr && recorder_->wants_remarks())
      recorder_->note({{}, path_, what, 0, {}, 0, make()});
  }

protected:
  traced_base() = default;
  ~traced_base() override = default;

  /// What the actor is handling at this moment. @pre it has its turn
  [[nodiscard]] virtual const caf::mailbox_element* handled() const = 0;

  /// Who gives numbers to what it does; nullptr: nobody records.
  [[nodiscard]] provenance_source* recorded() {
    return recorder_ != nullptr && recorder_->wants_remarks() ? this : nullptr;
  }

  /// Hands what is for this actor to its process, if that is not the one that this thread executes.
  /// @returns whether it did: then `x` is moved from
  [[nodiscard]] bool crosses(caf::abstract_actor& self, caf::mailbox_element_ptr& x) {
    return process_ != nullptr && process_ != executed_process && cross(self, x);
  }

  void record(const caf::mailbox_element& x, bool heard) {
    if (recorder_ != nullptr)
      recorder_->record(part(), *this, x, heard);
  }

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
  friend class trace_recorder;

  [[nodiscard]] bool cross(caf::abstract_actor& self, caf::mailbox_element_ptr& x);
  [[nodiscard]] trace_part& part() const;

  std::string path_;
  std::uint64_t path_hash_ = 0;
  std::uint64_t fold_ = 0; ///< of what it was delivered
  process* process_ = nullptr;
  trace_recorder* recorder_ = nullptr;
  bool is_watched_ = false; ///< somebody sees what it is delivered
};

/// Adds the trace to a kind of actor. Messages to an actor without path are not folded.
/// @tparam Base caf::event_based_actor or a Handle::base
template <class Base>
class traced : public Base, public traced_base {
public:
  using Base::Base;
  using Base::enqueue;

  void enqueue(caf::mailbox_element_ptr x, caf::execution_unit* unit) override {
    if (crosses(*this, x))
      return;
    record(*x, !this->getf(caf::abstract_actor::is_terminated_flag));
    Base::enqueue(std::move(x), unit);
  }

  caf::resumable::resume_result resume(caf::execution_unit* unit, std::size_t messages) override {
    const turn_of recorded_turn(recorded());
    const turn its_turn(*this);
    return Base::resume(unit, messages);
  }

protected:
  [[nodiscard]] const caf::mailbox_element* handled() const override {
    return const_cast<traced*>(this)->current_mailbox_element(); // CAF's accessor is not const
  }
};

/// A traced function-based actor with state; its behaviour function is
/// `Handle::behavior_type f(traced_pointer<State, Handle> self, ...)`.
template <class State, class Handle>
using traced_actor = caf::stateful_actor<State, traced<typename Handle::base>>;

template <class State, class Handle>
using traced_pointer = traced_actor<State, Handle>*;

/// An actor handle inside a message struct: it is sent, but neither folded nor serialized, so that
/// no actor id reaches the trace. It does not survive the way to another process.
template <class Handle>
struct carried {
  Handle actor;
};

template <class Inspector, class Handle>
typename Inspector::result_type inspect(Inspector& f, carried<Handle>&) {
  return f(caf::meta::type_name("carried"));
}

} // namespace rubicon::scheduler
