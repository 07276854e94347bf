// Messages between the actors of a fixture, on their way: held, lost, late or repeated as a test
// wants it.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <caf/actor_control_block.hpp>

#include "core/time.hpp"
#include "scheduler/messages/envelope.hpp"
#include "scheduler/process.hpp"

namespace rubicon::test {

/// Which messages are meant.
struct message_pattern {
  const scheduler::message_type* type = nullptr;
  std::function<bool(const scheduler::envelope&)> fits; ///< of that type; empty: all do
  std::optional<caf::actor_id> from;                    ///< unset: anybody's
  std::optional<caf::actor_id> to;                      ///< unset: for anybody
};

/// What becomes of a message that fits.
struct mishap {
  enum class kind : std::uint8_t { drop, delay, duplicate };
  kind what = kind::drop;
  duration length{}; ///< of a delay
};

class mail final : public scheduler::delivery_tap {
public:
  struct letter {
    caf::strong_actor_ptr to;
    scheduler::envelope_ptr content;
    caf::strong_actor_ptr from;
  };

  /// Puts a message on its way for good, at a time.
  using late_delivery = std::function<void(letter, duration)>;

  /// @param hold whether messages wait until they are delivered here
  mail(bool hold, late_delivery later) : hold_(hold), later_(std::move(later)) {}

  /// A message is sent. @returns whether it is kept here; the content is moved out then
  bool takes(scheduler::actor& to, scheduler::envelope_ptr& content,
             scheduler::actor* from) override;

  /// It happens to the first message on its way that fits, or else to the next that is sent.
  void plan(message_pattern which, mishap what);

  /// The next message for the receiver that the pattern names, if it fits; nothing: another is
  /// next, or none.
  [[nodiscard]] const letter* next(const message_pattern& x) const;

  /// The first that fits, whatever is before it.
  [[nodiscard]] const letter* find(const message_pattern& x) const;

  /// Hands over that message, or the first of all. Nobody has handled anything yet.
  void deliver(const letter& x);
  bool deliver_first();

  [[nodiscard]] bool holds() const { return hold_; }
  [[nodiscard]] bool empty() const { return letters_.empty(); }

  /// From now on nothing is kept, and what was is gone.
  void close();

  /// An actor whose messages go through here.
  void add(scheduler::actor& who, std::string path);

  /// One of them; nullptr: it is another, or gone.
  [[nodiscard]] caf::strong_actor_ptr actor_of(caf::actor_id x) const;

  /// `radio_send from sink/kitchen to fake/1`
  [[nodiscard]] std::string text(const message_pattern& x) const;

  /// A line for each message on its way.
  [[nodiscard]] std::string text() const;

  /// What the next message for that receiver is, for a failure.
  [[nodiscard]] std::string text_of_next(const message_pattern& x) const;

private:
  struct known_actor {
    caf::weak_actor_ptr handle;
    std::string path;
  };

  struct planned {
    message_pattern which;
    mishap what;
  };

  [[nodiscard]] static bool matches(const message_pattern& x, const letter& y);
  [[nodiscard]] std::string text(const letter& x) const;
  [[nodiscard]] std::string name_of(caf::actor_id x) const; ///< 0: nobody
  void hand_over(letter x);
  /// Lets it happen to a message. @returns what is left of it to be sent now, in order
  std::vector<letter> befall(letter x, mishap what);

  bool hold_;
  bool closed_ = false;
  bool passes_ = false; ///< what is sent at this moment was here before
  late_delivery later_;
  std::deque<letter> letters_;
  std::vector<planned> planned_;
  std::map<caf::actor_id, known_actor> actors_;
};

} // namespace rubicon::test
