// The face of a tagged object in the tuple space: a milk box, perceived now by this reader and now
// by that (D1.1 3.2.2; PXY-03..08).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "proxy/classes/proxy_class.hpp"
#include "proxy/classes/signature.hpp"
#include "proxy/classes/tuple_template.hpp"
#include "proxy/interface_choice.hpp"
#include "proxy/proxy.hpp"

namespace rubicon::proxy {

struct object_settings {
  duration lost_after = 2s; ///< not perceived by anybody
  double hysteresis_db = 4; ///< another interface must be stronger by so much
};

struct object_counters {
  std::uint64_t percepts = 0;
  std::uint64_t switches = 0;       ///< from one interface to another
  std::uint64_t short_memories = 0; ///< too short for the class: dropped
  std::uint64_t bad_values = 0;     ///< strengths that are no number: dropped
  std::uint64_t foreign_tuples = 0; ///< not about this object: dropped
  std::uint64_t bad_keys = 0;       ///< own keys over the limits: not published
};
RUBICON_FIELDS(object_counters, percepts, switches, short_memories, bad_values, foreign_tuples,
               bad_keys);

/// Own tuples, below the class's prefix, in which {name}, {id} and {channel} stand for the object:
///   status, status.cause, status.since   `active`, or `lost` because `not_perceived`
///   class, id                            the class's name, `rfid/e00401`
///   PROPERTY                             of the class, and of the object if the class knows it
///   FIELD, FIELD.unit                    what the object's memory says
///   interface, position                  which interface perceives it best, and where that is
/// and the class's templates, under keys of their own.
class object_proxy {
public:
  using output = std::variant<publish>;
  using outputs = std::vector<output>;

  object_proxy() = default;
  /// @param percept what it is for; its class claims it
  object_proxy(proxy_class what, signature percept, object_settings settings = {});

  [[nodiscard]] outputs start(instant now);

  /// Keys to subscribe to, of any owner.
  [[nodiscard]] std::vector<std::string> watches() const;

  /// Whether the percept is this proxy's object (PXY-08).
  [[nodiscard]] bool consumes(const signature& percept) const { return percept == percept_; }

  [[nodiscard]] outputs on_tuple(peer_id owner, std::string_view key, byte_view value, bool deleted,
                                 instant now);
  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const { return lost_at_; }

  [[nodiscard]] bool is_active() const { return active_; }
  /// Which reader perceives it best; empty: none.
  [[nodiscard]] std::string interface_name() const;
  /// What it says of the object, by name.
  [[nodiscard]] const std::map<std::string, std::string>& values() const { return values_; }
  [[nodiscard]] const std::string& prefix() const { return prefix_; }
  [[nodiscard]] const proxy_class& what() const { return class_; }
  [[nodiscard]] const object_counters& counters() const { return counters_; }

private:
  void say(std::string_view suffix, std::string text, outputs& out);
  void say_under(std::string key, std::string text, outputs& out);
  void say_state(std::string_view cause, instant now, outputs& out);
  void say_interface(outputs& out);
  void read(byte_view memory, instant now, outputs& out);
  void follow(bool chose_anew, instant now, outputs& out);

  proxy_class class_;
  signature percept_;
  object_settings settings_;
  std::string prefix_;
  tuple_templates templates_;
  std::optional<known_object> known_;
  interface_choice choice_;
  std::map<interface_id, std::string> places_;
  std::optional<bytes> memory_; ///< as last read
  std::map<std::string, std::string> values_;
  bool active_ = true;
  std::optional<instant> lost_at_; ///< if no reader perceives it until then
  object_counters counters_;
};

} // namespace rubicon::proxy
