// Proxies whose meaning no table can say: a program in C++ that completes a proxy class, and the
// registry in which files find it by its name (PXY-04).
//
// To write one: derive from `program`, write a maker for it, and add both under a name to a
// registry: `auto programs = proxy::built_in_programs(); programs.add("mine", make_mine);`. Files
// that are loaded with that registry (config/load.hpp) may say `program = "mine"` in a [[proxy]].
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/time.hpp"
#include "proxy/classes/layout.hpp"
#include "proxy/classes/proxy_class.hpp"

namespace rubicon::proxy {

/// The code of one proxy. Like all cores it knows no clock, actor or file: time comes as an
/// argument, and what it has to say is returned.
///
/// What it says becomes tuples below the proxy's prefix, as fields do: `name`, and `name.unit` the
/// first time if the unit is not empty. Names that are not in names() are dropped and counted.
class program {
public:
  using readings = std::vector<reading>;

  program() = default;
  program(const program&) = delete;
  program& operator=(const program&) = delete;
  virtual ~program() = default;

  /// What it may say; constant. No field, input or property of its class has one of these names.
  [[nodiscard]] virtual std::vector<std::string> names() const = 0;

  /// The proxy starts. Called once, before the rest.
  [[nodiscard]] virtual readings start(instant now) = 0;

  /// What one message, or one memory of a tagged object, says; in the order of the class's fields.
  [[nodiscard]] virtual readings on_readings(const readings& x, instant now) = 0;

  [[nodiscard]] virtual readings on_time(instant /*now*/) { return {}; } ///< harmless early

  /// When on_time() is due; after on_time(now) later than `now`, or time would stand still.
  [[nodiscard]] virtual std::optional<instant> deadline() const { return std::nullopt; }
};

/// From `settings` of a file: names and numbers.
using program_settings = std::vector<std::pair<std::string, double>>;

using program_factory = std::function<std::unique_ptr<program>()>;

/// Why a class cannot have the program.
struct program_problem {
  std::string setting; ///< of which setting; empty: of the class as a whole
  std::string message;
};

/// Judges settings against the class, whose fields are known, and binds them. The factory is called
/// once for each proxy, so that no two share state.
using program_maker = std::function<std::variant<program_factory, program_problem>(
    const proxy_class& what, const program_settings& settings)>;

/// Programs by name. A value: whoever loads files passes the one that it wants.
class program_registry {
public:
  /// @returns whether the name was free; otherwise nothing is changed
  bool add(std::string name, program_maker make) {
    return makers_.emplace(std::move(name), std::move(make)).second;
  }

  /// nullptr if there is none of that name.
  [[nodiscard]] const program_maker* find(std::string_view name) const {
    const auto found = makers_.find(name);
    return found == makers_.end() ? nullptr : &found->second;
  }

  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& [name, make] : makers_)
      out.push_back(name);
    return out;
  }

private:
  std::map<std::string, program_maker, std::less<>> makers_;
};

/// Those that every binary has: `occupancy`.
[[nodiscard]] program_registry built_in_programs();

/// Says `occupied` (`yes` or `no`) and `occupied.by` (the field that noticed somebody first) from
/// several fields together: each setting that is the name of a field is the value above which it
/// speaks of somebody; `hold_s` (default 60, up to 86400) is for how many seconds that counts.
[[nodiscard]] std::variant<program_factory, program_problem>
make_occupancy(const proxy_class& what, const program_settings& settings);

} // namespace rubicon::proxy
