// Messages of a flood that a bridge reads later.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace rubicon::bridge {

/// The newest message of each topic: it takes the place of one that waits, which nobody needs any
/// more. What has no room is dropped.
class waiting_messages {
public:
  static constexpr std::size_t topics_max = 1000;
  static constexpr std::size_t octets_max = 4 * 1024 * 1024; ///< of topics and messages

  /// @returns whether one has been dropped: an older one, or this one for want of room
  [[nodiscard]] bool keep(std::string_view topic, std::string_view text) {
    const auto older = messages_.find(topic);
    const bool is_new = older == messages_.end();
    const auto more = is_new ? topic.size() + text.size() : text.size();
    const auto less = is_new ? 0 : older->second.size();
    if ((is_new && messages_.size() >= topics_max) || octets_ - less + more > octets_max)
      return true;
    octets_ += more - less;
    if (is_new)
      messages_.emplace(topic, text);
    else
      older->second = text;
    return !is_new;
  }

  /// All of them, by topic.
  [[nodiscard]] std::map<std::string, std::string, std::less<>> take() {
    octets_ = 0;
    return std::exchange(messages_, {});
  }

  /// @returns whether there was one, which is dropped
  bool forget(std::string_view topic) {
    const auto found = messages_.find(topic);
    if (found == messages_.end())
      return false;
    octets_ -= found->first.size() + found->second.size();
    messages_.erase(found);
    return true;
  }

  [[nodiscard]] bool empty() const { return messages_.empty(); }
  [[nodiscard]] std::size_t size() const { return messages_.size(); }

private:
  std::map<std::string, std::string, std::less<>> messages_;
  std::size_t octets_ = 0;
};

} // namespace rubicon::bridge
