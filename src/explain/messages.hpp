// For files of this room only: which message some octets carry, and what programs say of messages.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "explain/content.hpp"
#include "explain/growth.hpp"

namespace rubicon::explain {

/// Every message begins by itself (`begun`, "message"), so what is caused by it is known to carry
/// it; octets are asked only what of it they are. What comes from outside of the ecology begins
/// where it is seen first.
class message_follower {
public:
  explicit message_follower(growth& all) : all_(all) {}

  /// The remaining fields follow from what it causes.
  void on_begun(const record& r);

  // actions of programs, and what they are notified of
  void on_send(const record& r);
  void on_message(const record& r);
  void on_send_ended(const record& r);
  void on_ended(const record& r);

  /// @param cause of the octets
  /// @param here the island they are in
  [[nodiscard]] std::optional<sighting> recognise(const carried_fragment& x, std::uint64_t cause,
                                                  island_id here, const record& r);
  [[nodiscard]] std::optional<sighting> recognise(const envelope& x, std::uint64_t cause,
                                                  const record& r);
  [[nodiscard]] std::optional<sighting> recognise(const channel_content& x, island_id here,
                                                  const record& r);
  /// Packets of the measuring apps, which have numbers.
  [[nodiscard]] std::optional<sighting> recognise_flow(byte_view octets, island_id here,
                                                       const record& r);
  /// Events of groups, which are encrypted: a frame is known by its cause only. Other frames of
  /// groups have no cause.
  [[nodiscard]] std::optional<sighting> recognise_event(island_id here, const record& r);
  /// A later fragment says nothing of itself.
  [[nodiscard]] std::optional<sighting> recognise_rest(std::uint64_t cause) const;

private:
  std::uint32_t begin(message x, std::uint64_t number, const record& r);
  [[nodiscard]] std::optional<sighting> seen(message x, std::uint64_t cause, const record& r);
  [[nodiscard]] std::optional<sighting> answered(cargo of, const char* kind, bool turned_away,
                                                 std::uint64_t cause);

  growth& all_;
  std::map<mote_address, std::uint32_t> numbers_; ///< of the last message by source
  std::map<std::pair<std::string, std::uint64_t>, std::uint32_t> unended_; ///< by program and token
  std::map<std::tuple<island_id, mote_id, std::uint64_t>, std::uint32_t> measuring_; ///< by number
  std::set<std::uint64_t> accounted_;            ///< begins of messages that the run accounts for
  std::map<std::uint64_t, mote_id> subscribers_; ///< of events, by the number of their begin
};

} // namespace rubicon::explain
