// What works beside a PEIS kernel and knows nothing but tuples: rules, translations, collectors,
// pursuers of goals, readers of tags. One actor hosts any of them (actors/peis/component.hpp), so
// that a new one is one class.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"

namespace rubicon::components {

struct tuple_name {
  peer_id owner;
  std::string key;
};

/// What has become of a watched tuple. Views are valid during the call only.
struct news {
  std::uint64_t watch = 0;
  peer_id owner;
  std::string_view key;
  std::string_view text;
  bool deleted = false;
};

/// What a watch reports: the tuple of that name by on_tuple(); of a meta tuple where it points by
/// on_reference(), or the tuple there by on_tuple().
enum class watched : std::uint8_t { tuple, reference, target };

/// Report changes of this from now on.
struct watch {
  std::uint64_t number = 0; ///< comes back
  peer_id owner;            ///< any_peer: of whomever
  std::string key;
  watched what = watched::tuple;
};

/// Set this own tuple.
struct publish {
  std::string key;
  bytes value;
  bool text = true;
};

/// Delete this own tuple.
struct erase {
  std::string key;
};

/// Make this own tuple a meta tuple, unless it is one already.
struct declare {
  std::string key;
  std::string reference; ///< where it points; empty: at the own tuple `target`
  std::string target;
};

/// Set somebody's tuple.
struct write {
  peer_id owner;
  std::string key;
  std::string text;
  bool meta = false;       ///< it is a meta tuple, and this is where it is to point
  std::uint64_t token = 0; ///< comes back with the outcome; 0: nobody asks for that
};

/// Something that people who follow the run should know.
struct tell {
  std::string what;
  std::string who = {}; ///< empty: the component's path
};

using output = std::variant<watch, publish, erase, declare, write, tell>;
using outputs = std::vector<output>;

/// For the report; empty: it has no part in that.
using figures = std::vector<std::pair<std::string, double>>;

/// All that a struct counts: `bad_values` as `bad values`. The struct is always named:
/// tests/architecture/counters_shown looks for it.
template <described Counters>
void add_figures(figures& to, const Counters& x, const std::string& before = {}) {
  for_each_field(x, [&](std::string_view field, std::uint64_t count) {
    auto name = before + std::string(field);
    std::ranges::replace(name, '_', ' ');
    to.emplace_back(std::move(name), static_cast<double>(count));
  });
}

class component {
public:
  virtual ~component() = default;

  [[nodiscard]] virtual outputs start(instant now) = 0;
  [[nodiscard]] virtual outputs on_tuple(const news& /*x*/, instant /*now*/) { return {}; }
  /// @param to nothing: nowhere, or nobody understands it
  virtual void on_reference(std::uint64_t /*watch*/, const std::optional<tuple_name>& /*to*/) {}
  /// What has become of a write with a token.
  /// @param cause empty: its owner has taken it; else as peis::to_string() has it
  [[nodiscard]] virtual outputs on_written(std::uint64_t /*token*/, std::string_view /*cause*/,
                                           instant /*now*/) {
    return {};
  }
  [[nodiscard]] virtual outputs on_time(instant /*now*/) { return {}; } ///< harmless early
  [[nodiscard]] virtual std::optional<instant> deadline() const { return std::nullopt; }
  [[nodiscard]] virtual components::figures figures() const { return {}; }

protected:
  component() = default;
  component(const component&) = default;
  component(component&&) = default;
  component& operator=(const component&) = default;
  component& operator=(component&&) = default;
};

/// One that also waits for what comes from outside the ecology, in wall time.
class outside_component : public component {
public:
  /// Before start(). @param wake asks for a call of on_input(); for any thread
  virtual void attach(std::function<void()> wake) = 0;
  [[nodiscard]] virtual outputs on_input(instant now) = 0; ///< harmless if nothing has come
};

} // namespace rubicon::components
