// Who decides that a tagged object needs a proxy (D1.1 3.2.2; PXY-02, PXY-09..11).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "proxy/classes/class_table.hpp"
#include "proxy/classes/signature.hpp"
#include "proxy/interface_choice.hpp"

namespace rubicon::proxy {

/// Start a proxy of that class for the object. object_manager::classes() has the class.
struct start_object_proxy {
  signature percept;
  std::string class_name;
};

/// No class claims the object (PXY-10); reported once until the classes change.
struct unknown_object {
  signature percept;
};

struct object_manager_counters {
  std::uint64_t started = 0;
  std::uint64_t bad_lists = 0;      ///< `objects` that is no list: dropped
  std::uint64_t foreign_tuples = 0; ///< tuples of no interface: dropped
  std::uint64_t refused = 0;        ///< objects or interfaces beyond the limits: dropped
};
RUBICON_FIELDS(object_manager_counters, started, bad_lists, foreign_tuples, refused);

/// Listens to the lists of all interfaces, whoever owns them, and starts one proxy for every object
/// that a class claims. The proxy itself finds out who perceives it, and outlives its absence.
class object_manager {
public:
  using output = std::variant<start_object_proxy, unknown_object>;
  using outputs = std::vector<output>;

  explicit object_manager(class_table classes = {}, std::size_t objects_max = 65536)
      : classes_(std::move(classes)), objects_max_(objects_max) {}

  /// A tuple of an interface has a new value, or is there no more.
  [[nodiscard]] outputs on_tuple(peer_id owner, std::string_view key, byte_view value,
                                 bool deleted);

  /// Other latent classes; objects without a proxy are looked up again.
  [[nodiscard]] outputs on_classes(class_table classes);

  /// A proxy has ended by itself. If its object is perceived a new one is started.
  [[nodiscard]] outputs on_proxy_gone(const signature& percept);

  [[nodiscard]] const class_table& classes() const { return classes_; }
  [[nodiscard]] const object_manager_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t running() const { return running_.size(); }

private:
  using object = std::pair<std::string, std::string>; ///< channel and hardware id

  struct interface {
    std::string channel; ///< empty: not known yet
    std::vector<std::string> perceived;
  };

  void review(const interface& x, outputs& out);

  class_table classes_;
  std::size_t objects_max_;
  std::map<interface_id, interface> interfaces_;
  std::set<object> running_;
  std::set<object> unknown_; ///< those reported as unknown
  object_manager_counters counters_;
};

} // namespace rubicon::proxy
