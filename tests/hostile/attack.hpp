// What hostile peers do. Each attack is a small class: what its links say, and how they behave
// towards what they hear. The player opens the links, keeps the rate and counts.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hostile/link.hpp"

namespace rubicon::hostile {

class attack {
public:
  explicit attack(const target& whom) : whom_(whom) {}
  virtual ~attack() = default;
  attack(const attack&) = delete;
  attack& operator=(const attack&) = delete;

  /// The link is up: how it introduces itself.
  virtual void open(link& x) { x.greet(); }

  /// The next package of that link, or a few that belong together. Called as often as the rate and
  /// the link's room allow; not called while a long message is being sent.
  virtual void say(link& x) = 0;

  /// Does that link read its socket?
  [[nodiscard]] virtual bool reads(const link&) const { return true; }
  virtual void hear(link& x, const peis::received_package& heard) { x.acknowledge(heard); }

  /// Octets that the system holds unread for a link; 0: its default.
  [[nodiscard]] virtual int receive_buffer() const { return 0; }

  /// How soon a link that was cut off or has gone is tried again.
  [[nodiscard]] virtual duration reopened_after() const { return 100ms; }

protected:
  [[nodiscard]] const target& whom() const { return whom_; }

private:
  target whom_;
};

struct attack_kind {
  std::string_view name;
  std::string_view what;
  /// Calls of say() a second over all links; 0: as many as TCP takes.
  double rate = 0;
  std::function<std::unique_ptr<attack>(const target&)> make;
  /// Counts of the report (see report.hpp) of which at least one tells of this attack; empty: it is
  /// served like anybody, and nothing is dropped.
  std::vector<std::string_view> told;
  /// It is its links that do harm: many are played with more than a peer takes.
  bool crowd = false;
};

/// Links that a crowd has in place of `links`, if these are many.
[[nodiscard]] std::size_t crowd_of(const attack_kind& kind, std::size_t links);

/// All of them, in the order in which they are played.
[[nodiscard]] const std::vector<attack_kind>& all_attacks();

// Their parts, by what they are aimed at.
[[nodiscard]] std::vector<attack_kind> network_attacks();  ///< hosts, routes, broadcasts, clock
[[nodiscard]] std::vector<attack_kind> identity_attacks(); ///< lies about who is who, and where
[[nodiscard]] std::vector<attack_kind> tuple_attacks();
[[nodiscard]] std::vector<attack_kind> message_attacks(); ///< packages, fragments, acknowledgements
[[nodiscard]] std::vector<attack_kind> link_attacks();

/// An attack that is nothing but what it says.
template <class Say>
class saying : public attack {
public:
  saying(const target& whom, Say f) : attack(whom), say_(std::move(f)) {}
  void say(link& x) override { say_(x); }

private:
  Say say_;
};

template <class Say>
[[nodiscard]] std::function<std::unique_ptr<attack>(const target&)> always(Say f) {
  return [f](const target& whom) { return std::make_unique<saying<Say>>(whom, f); };
}

} // namespace rubicon::hostile
