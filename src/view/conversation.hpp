// What the live page asks and is told (docs/view.md): one for each page that is open.
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

/// What somebody does by hand to the run; each returns what came of it, in words.
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

/// What every page is told first, and what it says of motes.
struct introduction {
  std::string facts; ///< the message `ecology`, with facts
  std::vector<mote_index> motes;
  std::map<mote_address, std::size_t> index; ///< of `motes`
  std::map<peer_id, std::string> peers;
};

/// @param facts of which nobody has to be able to read anything
[[nodiscard]] introduction introduction_of(std::string facts);

class conversation {
public:
  /// @param about shared by all pages
  /// @param controls nothing: the page only looks
  conversation(std::shared_ptr<const timeline> all, std::shared_ptr<const introduction> about,
               std::shared_ptr<const controls> controls);

  /// The answer to a question; `refused` if it is none.
  [[nodiscard]] std::string on_text(std::string_view text);

  /// What the page has not been told yet: the ecology, then states and moments.
  [[nodiscard]] std::optional<std::string> news();

private:
  class answerer;

  std::shared_ptr<const timeline> all_;
  std::shared_ptr<const introduction> about_;
  std::shared_ptr<const controls> controls_;
  bool introduced_ = false;
  bool follows_ = true;
  std::uint64_t events_told_ = 0;
  run_state state_told_;
  bool has_told_ = false;
  bool told_state_last_ = false;
  std::size_t samples_told_ = 0;
};

} // namespace rubicon::view
