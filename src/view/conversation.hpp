// Requests of the live page, and what is sent to it (docs/view.md): one for each open page.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "view/timeline.hpp"

namespace rubicon::view {

/// Manual actions on the run; each returns its result, in words.
struct controls {
  struct outcome {
    bool ok = false;
    std::string text;
  };
  std::function<outcome(const std::string& sentence)> fault;
  std::function<outcome(const std::string& owner, const std::string& key, const std::string& value)>
      set_tuple;
};

/// A mote's place in the columns of a moment.
struct mote_index {
  mote_address address;
  std::string name; ///< `kitchen/stove`
  std::string type;
  bool is_mac = false; ///< its island has radio and medium access only
};

/// What is sent to every page first, and the motes and peers that it names.
struct introduction {
  std::string facts; ///< the message `ecology`, with facts
  std::vector<mote_index> motes;
  std::map<mote_address, std::size_t> index; ///< of `motes`
  std::map<peer_id, std::string> peers;
};

/// @param facts may be malformed: what cannot be read is left out
[[nodiscard]] introduction introduction_of(std::string facts);

class conversation {
public:
  /// @param about shared by all pages
  /// @param controls nullptr: the page is read-only
  conversation(std::shared_ptr<const timeline> all, std::shared_ptr<const introduction> about,
               std::shared_ptr<const controls> controls);

  /// The answer to a question; `refused` if it is none.
  [[nodiscard]] std::string on_text(std::string_view text);

  /// What has not been sent to the page yet: the ecology, then states and moments.
  [[nodiscard]] std::optional<std::string> news();

private:
  class answerer;

  std::shared_ptr<const timeline> all_;
  std::shared_ptr<const introduction> about_;
  std::shared_ptr<const controls> controls_;
  bool introduced_ = false;
  bool follows_ = true;
  std::uint64_t events_sent_ = 0;
  run_state state_sent_;
  bool has_sent_state_ = false;
  bool last_was_state_ = false;
  std::size_t samples_sent_ = 0;
};

} // namespace rubicon::view
