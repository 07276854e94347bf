// The messages and frames of a run as far as it is recorded, so that any of them is found at once.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "explain/traces.hpp"

namespace rubicon::view {

struct listed_message {
  std::string name; ///< `kitchen/climate-7#12`
  mote_address source;
  mote_address destination;
  std::string from;
  std::string to;
  instant sent;
  std::optional<instant> ended; ///< nothing: it was in flight when the record ended
  std::string outcome;          ///< in words
  std::string_view kind;        ///< `lost`, `open` or `arrived`
};

/// A frame that carried something of a message.
struct listed_frame {
  instant begin;
  duration length{};
  std::string from; ///< actor paths; `to` is empty: a broadcast
  std::string to;
  bool received = false;
};

class message_list {
public:
  /// @param is_whole the run is over: nothing will be added to it
  explicit message_list(std::shared_ptr<const explain::traces> all, bool is_whole = true);

  [[nodiscard]] const explain::traces& traces() const { return *all_; }
  [[nodiscard]] bool is_whole() const { return is_whole_; }
  [[nodiscard]] const std::vector<listed_message>& messages() const { return messages_; }
  [[nodiscard]] const std::vector<listed_frame>& frames() const { return frames_; } ///< by time

  /// The whole path of a message, as `rubicon explain` prints it; else why there is none.
  [[nodiscard]] std::string explain_message(std::string_view name) const;

  /// Where the value that a tuple had at a time came from, likewise.
  [[nodiscard]] std::string explain_tuple(const std::string& owner, const std::string& key,
                                          instant at) const;

private:
  std::shared_ptr<const explain::traces> all_;
  bool is_whole_;
  std::vector<listed_message> messages_;
  std::vector<listed_frame> frames_;
};

} // namespace rubicon::view
