// The trace of a run: every message delivered to a traced actor, folded into 64 bits, so that two
// runs can be compared by one number (GEN-07, ACT-05).
#pragma once

#include <any>
#include <cstdint>
#include <functional>
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

/// Folds deliveries: receiver's path, ecology time, types and content, in order of delivery.
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

  /// Called for every delivery from now on, after it is folded; for debugging. Must not send.
  void observe(observer x) { observer_ = std::move(x); }

  /// The same for remarks. Must not send. From now on it is known what led to what.
  void observe_remarks(remark_observer x) { remark_observer_ = std::move(x); }
  [[nodiscard]] bool wants_remarks() const { return static_cast<bool>(remark_observer_); }

  /// @param heard whether the receiver still lives
  void record(std::uint64_t path_hash, std::string_view path, const caf::mailbox_element& x,
              bool heard = true);

  void note(remark x);

  /// Gives a number to what `path` begins, and tells it. @pre wants_remarks()
  [[nodiscard]] std::uint64_t begin(std::string_view path, std::string_view what, std::uint64_t id);

  /// Of a delivery that is being handled; 0: none, or nothing is.
  [[nodiscard]] std::uint64_t number_of(const caf::mailbox_element* x) const;

  /// The trace so far: equal for equal runs, on any machine.
  [[nodiscard]] std::uint64_t hash() const { return fold_.value(); }

  /// Deliveries so far.
  [[nodiscard]] std::uint64_t events() const { return events_; }

private:
  struct type_entry {
    std::uint64_t hash = 0;
    bool opaque = false; ///< only the type's name is folded
  };

  void fold(const caf::type_erased_tuple& content);
  [[nodiscard]] type_entry entry_of(caf::rtti_pair type);
  [[nodiscard]] type_entry entry_of_number(std::uint16_t number);
  [[nodiscard]] std::unique_lock<std::mutex> guard() const;

  const caf::actor_clock* clock_ = nullptr;
  bool shared_ = false;
  std::thread::id home_;
  mutable std::mutex mutex_; ///< held while recording if shared_
  fold64 fold_;
  std::uint64_t events_ = 0;
  std::uint64_t numbers_given_ = 0;
  observer observer_;
  remark_observer remark_observer_;
  /// The newest delivery at each address that a mailbox element has had; kept for an observer only,
  /// and only ever looked up.
  std::unordered_map<const caf::mailbox_element*, std::uint64_t> numbers_;
  std::vector<type_entry> numbered_types_;
  std::unordered_map<const std::type_info*, type_entry> named_types_;
  const std::type_info* last_type_ = nullptr;
  type_entry last_entry_;
};

/// What a traced actor knows about itself.
class traced_base : public provenance_source {
public:
  /// Where the actor stands in the ecology, such as `island/7/mote/12`; empty if it was never
  /// placed.
  [[nodiscard]] const std::string& path() const { return path_; }

  /// Gives the actor its path and its recorder. Must happen right after the spawn, before anything
  /// runs; the spawn helpers in spawn.hpp and world.hpp do it.
  void place(std::string path, trace_recorder* recorder);

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

  void record(const caf::mailbox_element& x, bool heard) {
    if (recorder_ != nullptr)
      recorder_->record(path_hash_, path_, x, heard);
  }

private:
  std::string path_;
  std::uint64_t path_hash_ = 0;
  trace_recorder* recorder_ = nullptr;
};

/// Adds the trace to a kind of actor. Messages to an actor without path are not folded.
/// @tparam Base caf::event_based_actor or a Handle::base
template <class Base>
class traced : public Base, public traced_base {
public:
  using Base::Base;
  using Base::enqueue;

  void enqueue(caf::mailbox_element_ptr x, caf::execution_unit* unit) override {
    record(*x, !this->getf(caf::abstract_actor::is_terminated_flag));
    Base::enqueue(std::move(x), unit);
  }

  caf::resumable::resume_result resume(caf::execution_unit* unit, std::size_t messages) override {
    const turn_of turn(recorded());
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
