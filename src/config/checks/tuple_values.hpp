// Values that tuples may have, and words that may be written to them, as far as a file says.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/plan/ecology.hpp"

namespace rubicon::config {

/// Values that the owner of a tuple publishes; more than one of these may apply.
struct published_values {
  bool anything = false;
  std::vector<std::string> words;
  std::vector<std::string> endings;               ///< words that stand behind another
  const proxy::field* field = nullptr;            ///< or what a count of this means,
  std::pair<std::int64_t, std::int64_t> counts{}; ///< from one of these to the other

  [[nodiscard]] bool may_be(std::string_view text) const;
  /// The least and the greatest number; nothing: it has words only. @pre not anything
  [[nodiscard]] std::optional<std::pair<double, double>> numbers() const;
  /// `"off" or "on"`, `numbers from 0 to 25.5 C`
  [[nodiscard]] std::string text() const;
};

/// Words that an owner accepts when they are written to its tuple.
struct accepted_words {
  bool anything = true;
  const proxy::input* input = nullptr;
  const goal::pursuer_config* pursuer = nullptr; ///< its goals are accepted

  [[nodiscard]] bool accepts(std::string_view word) const; ///< @pre not anything
  /// What ends a sentence about a word that is not accepted: `, which accepts "off" or "on"`.
  [[nodiscard]] std::string instead_of(std::string_view word) const;
};

struct tuple_value {
  published_values published;
  accepted_words accepted;
};

class tuple_values {
public:
  /// @param x outlives this
  explicit tuple_values(const ecology_description& x);

  /// One for each owner whose tuple may have the key; empty: the file describes none.
  [[nodiscard]] std::vector<tuple_value> of(std::string_view key) const;

private:
  struct proxy_of_mote {
    std::string prefix; ///< parts may be `*`
    const proxy::proxy_class* what = nullptr;
    const mote_description* mote = nullptr; ///< nullptr: one that the file does not describe
  };

  void add_proxies(const proxy_manager_app& x);
  [[nodiscard]] std::optional<tuple_value> of_proxy(const proxy_of_mote& x,
                                                    std::string_view key) const;
  [[nodiscard]] published_values of_field(const proxy_of_mote& x, const proxy::field& field) const;
  [[nodiscard]] bool is_rescaled(const proxy::proxy_class& what, const proxy::field& field) const;

  const ecology_description& all_;
  std::vector<proxy_of_mote> proxies_;
  std::vector<const goal::pursuer_config*> pursuers_;
  std::vector<std::string> others_; ///< patterns of keys whose values are not known
};

} // namespace rubicon::config
