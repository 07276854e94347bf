#include <algorithm>
#include <optional>
#include <string>
#include <variant>

#include "config/checks/tuple_keys.hpp"
#include "config/checks/tuple_values.hpp"
#include "config/checks/warnings.hpp"
#include "config/toml/document.hpp"
#include "core/text/spelling.hpp"

namespace rubicon::config {

namespace {

/// Kernels and inits publish tuples about themselves.
bool is_of_kernel(std::string_view key) {
  for (const auto* first : {"kernel", "peis", "components", "name", "rubicon"})
    if (may_be(std::string(first) + ".**", key) || may_be(first, key))
      return true;
  return key.starts_with('*'); // may be a tuple of any kernel
}

class tuple_warnings {
public:
  tuple_warnings(const ecology_description& x, warning_list& out)
      : keys_(tuple_keys(x)), values_(x), out_(out) {
    for (const auto& each : keys_)
      if (each.pattern.find('*') == std::string::npos)
        exact_.push_back(each.pattern);
  }

  void look_at(const tuple_use& x) {
    const bool known = std::ranges::any_of(
        keys_, [&x](const known_key& each) { return may_be(each.pattern, x.key); });
    if (!known && !is_of_kernel(x.key))
      out_.emplace_back(x.at, x.who + " `" + x.key + "`, a tuple that no component publishes" +
                                  (exact_.empty() ? "" : suggestion(x.key, exact_)));
  }

  void look_at(const tuple_write& x) {
    const auto found = values_.of(x.key);
    if (found.empty() ||
        std::ranges::any_of(found, [](const auto& each) { return each.accepted.anything; }))
      return;
    for (const auto& [word, at] : x.words)
      if (std::ranges::none_of(found,
                               [&](const auto& each) { return each.accepted.accepts(word); }))
        out_.emplace_back(at, x.who + " writes `" + word + "` to `" + x.key + '`' +
                                  found.front().accepted.instead_of(word));
  }

  void look_at(const tuple_test& x) {
    const auto found = values_.of(x.key);
    if (found.empty() ||
        std::ranges::any_of(found, [](const auto& each) { return each.published.anything; }))
      return;
    for (const auto& [text, at] : x.equals)
      if (std::ranges::none_of(found,
                               [&](const auto& each) { return each.published.may_be(text); }))
        out_.emplace_back(at, x.who + " waits until `" + x.key + "` is `" + text +
                                  "`, but its values are " + found.front().published.text() +
                                  meant(text, found.front().published.words));
    look_at_bounds(x, found);
  }

private:
  static std::string meant(const std::string& word, const std::vector<std::string>& known) {
    const auto near = nearest(word, known);
    return near.empty() ? "" : ": did you mean `" + near + "`?";
  }

  void look_at_bounds(const tuple_test& x, const std::vector<tuple_value>& found) {
    std::optional<std::pair<double, double>> range;
    for (const auto& each : found)
      if (const auto numbers = each.published.numbers())
        range = range ? std::pair(std::min(range->first, numbers->first),
                                  std::max(range->second, numbers->second))
                      : *numbers;
    const auto& bound = x.above ? x.above : x.below;
    if (!bound)
      return;
    const auto but = ", but its values are " + found.front().published.text();
    if (!range) {
      out_.emplace_back(bound->at, x.who + " compares `" + x.key + "` with " + shown(bound->value) +
                                       but + ", which are not numbers");
      return;
    }
    if (x.above && range->second < x.above->value)
      out_.emplace_back(x.above->at, x.who + " waits until `" + x.key + "` is " +
                                         shown(x.above->value) + " or more" + but);
    if (x.below && range->first >= x.below->value)
      out_.emplace_back(x.below->at, x.who + " waits until `" + x.key + "` is below " +
                                         shown(x.below->value) + but);
  }

  std::vector<known_key> keys_;
  std::vector<std::string> exact_;
  tuple_values values_;
  warning_list& out_;
};

} // namespace

bool strangers_may_come(const ecology_description& all) {
  return std::ranges::any_of(all.peers, [](const peer_description& x) {
    return has_real_links(x) || std::ranges::any_of(x.apps, [](const peer_app& app) {
             const auto* init = std::get_if<init_app>(&app);
             return init != nullptr && std::ranges::any_of(init->components, [](const auto& y) {
                      return y.peer.empty();
                    });
           });
  });
}

void warn_of_tuples(const ecology_description& x, const file_places& seen, warning_list& out) {
  if (seen.uses.empty())
    return;
  tuple_warnings found(x, out);
  if (!strangers_may_come(x))
    for (const auto& each : seen.uses)
      found.look_at(each);
  for (const auto& each : seen.writes)
    found.look_at(each);
  for (const auto& each : seen.tests)
    found.look_at(each);
}

} // namespace rubicon::config
