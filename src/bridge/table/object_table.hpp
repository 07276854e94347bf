// All objects that proxies stand for, as a bridge sees them in tuples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/table/class_model.hpp"
#include "core/address.hpp"
#include "core/component.hpp"
#include "core/describe/fields.hpp"

namespace rubicon::bridge {

/// What is known of one object.
struct object {
  peer_id owner;                               ///< of its tuples
  std::string name;                            ///< its prefix: `kitchen.fan`
  std::size_t model = 0;                       ///< index of its class
  std::string status;                          ///< as its proxy publishes it; empty: not yet known
  std::map<std::string, std::string> values;   ///< of fields, by name
  std::map<std::string, std::string> inputs;   ///< what was acknowledged last, by name
  std::map<std::string, std::string> outcomes; ///< of the last request, by name of its input

  [[nodiscard]] bool is_available() const { return status == "active"; }
};

enum class change_kind : std::uint8_t {
  appeared,
  disappeared,  ///< its tuples have been deleted; it is not in the table any more
  availability, ///< its status has changed
  value,
  outcome, ///< a request has ended
};

struct change {
  change_kind what = change_kind::value;
  std::string name;  ///< of the object
  std::string input; ///< of an outcome
};

struct object_table_counters {
  std::uint64_t values = 0;
  std::uint64_t appeared = 0;
  std::uint64_t disappeared = 0;
  std::uint64_t bad_names = 0;  ///< keys that are of no class, or longer than a name may be
  std::uint64_t bad_values = 0; ///< values longer than value_max, dropped
  std::uint64_t table_full = 0; ///< tuples of more objects than there is room for, dropped
};
RUBICON_FIELDS(object_table_counters, values, appeared, disappeared, bad_names, bad_values,
               table_full);

/// An object is in the table from its tuple `PREFIX.class` on; tuples that arrive before it are
/// kept. Tuples of other owners than that of this tuple are ignored.
class object_table {
public:
  static constexpr std::size_t value_max = 256; ///< octets

  explicit object_table(std::vector<class_model> classes = {}, std::size_t objects_max = 10'000);

  /// Keys to watch, each once.
  [[nodiscard]] std::vector<std::string> watched() const;

  [[nodiscard]] std::vector<change> on_tuple(const components::news& x);

  /// nullptr: there is none
  [[nodiscard]] const object* find(std::string_view name) const;
  [[nodiscard]] const class_model& model(const object& x) const { return classes_[x.model]; }
  [[nodiscard]] const std::vector<class_model>& classes() const { return classes_; }
  /// By name.
  [[nodiscard]] std::vector<const object*> all() const;
  [[nodiscard]] const object_table_counters& counters() const { return counters_; }

private:
  struct entry {
    object what;
    bool known = false; ///< its class is
  };
  struct place {
    std::string name;
    std::string suffix;
  };

  [[nodiscard]] std::optional<place> place_of(std::string_view key) const;
  [[nodiscard]] std::optional<std::size_t> class_of(std::string_view name,
                                                    std::string_view prefix) const;
  [[nodiscard]] std::vector<change> on_class(entry& at, const components::news& x);
  [[nodiscard]] std::vector<change> on_deleted(const place& at, const components::news& x);
  [[nodiscard]] std::vector<change> on_value(entry& at, const std::string& suffix,
                                             const components::news& x);

  std::vector<class_model> classes_;
  std::size_t objects_max_ = 0;
  std::map<std::string, entry, std::less<>> entries_; ///< by name in lower case
  object_table_counters counters_;
};

} // namespace rubicon::bridge
