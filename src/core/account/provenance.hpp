// What led to what, and which message something is a copy of. Each thing that waits or travels
// keeps both. Simulation only, as the packet tags of ns-3: it is on no wire, in no comparison, in
// no trace, and no decision depends on it. Numbers are given only while somebody records a run;
// accounts (core/account/message_ledger.hpp) are kept in every run.
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>
#include <utility>

#include "core/time.hpp"

namespace rubicon {

class message_account;
class message_ledger;

/// How many hold an account, which is what derives from this: @ref message_account alone. Counted
/// by account_ref.
class copy_count {
public:
  copy_count(const copy_count&) = delete;
  copy_count& operator=(const copy_count&) = delete;

  // An atomic addition costs more than most messages do otherwise.
  /// @param is_shared several threads may call this at a time
  void add(bool is_shared) {
    if (is_shared)
      copies_.fetch_add(1, std::memory_order_relaxed);
    else
      copies_.store(copies_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }
  /// @returns how many are left
  [[nodiscard]] std::uint32_t remove(bool is_shared) {
    if (is_shared)
      return copies_.fetch_sub(1, std::memory_order_acq_rel) - 1;
    const auto left = copies_.load(std::memory_order_relaxed) - 1;
    copies_.store(left, std::memory_order_relaxed);
    return left;
  }

protected:
  copy_count() = default;
  ~copy_count() = default;

private:
  std::atomic<std::uint32_t> copies_{0};
};

/// Stands for one copy of a message. When the last one is destroyed, the message has arrived or is
/// lost. May be copied and destroyed by any thread.
class account_ref {
public:
  account_ref() = default;
  explicit account_ref(copy_count* of) : of_(of) { add(); }
  account_ref(const account_ref& x) : of_(x.of_) { add(); }
  account_ref(account_ref&& x) noexcept : of_(std::exchange(x.of_, nullptr)) {}
  account_ref& operator=(const account_ref& x) {
    account_ref copy(x);
    std::swap(of_, copy.of_);
    return *this;
  }
  account_ref& operator=(account_ref&& x) noexcept {
    account_ref taken(std::move(x));
    std::swap(of_, taken.of_);
    return *this;
  }
  ~account_ref() {
    if (of_ != nullptr && of_->remove(is_shared_between_threads()) == 0)
      close(of_);
  }

  /// Several threads are about to execute a run: counts are kept atomically from now on.
  static void share_between_threads() { is_shared.store(true, std::memory_order_relaxed); }
  [[nodiscard]] static bool is_shared_between_threads() {
    return is_shared.load(std::memory_order_relaxed);
  }

  [[nodiscard]] explicit operator bool() const { return of_ != nullptr; }
  [[nodiscard]] copy_count* get() const { return of_; }

private:
  void add() {
    if (of_ != nullptr)
      of_->add(is_shared_between_threads());
  }
  /// No copy is left.
  static void close(copy_count* of) noexcept;

  static inline constinit std::atomic<bool> is_shared = false;

  copy_count* of_ = nullptr;
};

/// Who handles something at this moment: an actor.
class provenance_source {
public:
  provenance_source() = default;
  provenance_source(const provenance_source&) = delete;
  provenance_source& operator=(const provenance_source&) = delete;

  /// Number of something new that what is being done now has led to; 0: nothing is recorded.
  /// @param id distinguishes it from its like
  [[nodiscard]] virtual std::uint64_t begin(std::string_view what, std::uint64_t id) = 0;

  /// Where messages are accounted for; nullptr: nowhere.
  [[nodiscard]] virtual message_ledger* ledger() = 0;

  /// Where a loss happens, `mote/kitchen/climate-7`, in a text that lives as long as the ledger;
  /// and when.
  [[nodiscard]] virtual std::string_view place() const = 0;
  [[nodiscard]] virtual instant time() const = 0;

protected:
  virtual ~provenance_source() = default;
};

/// What a thread does at this moment. To hand it down by argument would put a parameter that no
/// protocol reads into most functions of all cores.
struct provenance_context {
  provenance_source* who = nullptr;
  std::uint64_t number = 0;      ///< of what is being handled
  copy_count* account = nullptr; ///< of the message that it is a copy of; somebody else holds it
  bool stops = false;            ///< `who` is being destroyed
};

inline constinit thread_local provenance_context provenance_here; // NOLINT

/// Where something came from. A member of this type, as it is made, keeps what was being done when
/// its owner was made.
class provenance {
public:
  provenance() : number_(provenance_here.number), account_(provenance_here.account) {}
  provenance(std::uint64_t number, account_ref account)
      : number_(number), account_(std::move(account)) {}

  [[nodiscard]] static provenance none() { return {0, {}}; }

  /// Of another part of what is being done, such as an attempt.
  [[nodiscard]] static provenance begin(std::string_view what, std::uint64_t id = 0);

  [[nodiscard]] std::uint64_t number() const { return number_; } ///< 0: from nothing known
  [[nodiscard]] const account_ref& account() const { return account_; }

  /// No part of any value.
  friend bool operator==(const provenance&, const provenance&) { return true; }

private:
  std::uint64_t number_ = 0;
  account_ref account_;
};

/// While this lives, what is made in this thread comes from `x`, whatever is being handled.
class acting_on {
public:
  explicit acting_on(provenance x)
      : of_(std::move(x)), number_(std::exchange(provenance_here.number, of_.number())),
        account_(std::exchange(provenance_here.account, of_.account().get())) {}
  ~acting_on() {
    provenance_here.number = number_;
    provenance_here.account = account_;
  }
  acting_on(const acting_on&) = delete;
  acting_on& operator=(const acting_on&) = delete;

private:
  provenance of_;
  std::uint64_t number_;
  copy_count* account_;
};

/// While this lives, its thread does what `who` handles, at first nothing in particular.
class turn_of {
public:
  explicit turn_of(provenance_source* who)
      : before_(std::exchange(provenance_here, provenance_context{who})) {}
  ~turn_of() { provenance_here = before_; }
  turn_of(const turn_of&) = delete;
  turn_of& operator=(const turn_of&) = delete;

  /// From now on it handles this. @param account outlives what is done
  static void handles(std::uint64_t number, const account_ref& account) {
    provenance_here.number = number;
    provenance_here.account = account.get();
  }
  static void handles_nothing() { handles(0, {}); }

private:
  provenance_context before_;
};

/// While this lives, copies that are destroyed were held by somebody who has stopped.
class stopping {
public:
  stopping() : before_(std::exchange(provenance_here.stops, true)) {}
  ~stopping() { provenance_here.stops = before_; }
  stopping(const stopping&) = delete;
  stopping& operator=(const stopping&) = delete;

private:
  bool before_;
};

} // namespace rubicon
