// Who decides that a mote needs a proxy (D1.1 3.2.2, 4.2.5).
#pragma once

#include <cstddef>
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
#include "core/tuples/device_keys.hpp"
#include "proxy/classes/class_table.hpp"
#include "proxy/classes/signature.hpp"
#include "proxy/proxy.hpp"

namespace rubicon::proxy {

/// Start a proxy of that class; the mote is present. manager::classes() has the class.
struct start_proxy {
  mote_address mote;
  std::string class_name;
};

/// End the mote's proxy: its mote has become one of another kind.
struct stop_proxy {
  mote_address mote;
};

/// Notify the running proxy whether its mote is there (PXY-16).
struct set_presence {
  mote_address mote;
  device_presence presence = device_presence::listed;
  std::string cause; ///< one word, of its having left: of the gateway's status tuple, or
                     ///< `not_listed`, `gateway_gone`
};

/// No class claims that type of mote (PXY-10); reported once per mote and type.
struct unknown_type {
  mote_address mote;
  std::uint32_t type = 0;
};

struct manager_counters {
  std::uint64_t started = 0;
  std::uint64_t stopped = 0;
  std::uint64_t bad_lists = 0;    ///< `devices` that is no list of motes: dropped
  std::uint64_t bad_types = 0;    ///< types that are not 4 octets, or of no possible mote: dropped
  std::uint64_t bad_statuses = 0; ///< status tuples that are none: dropped
  std::uint64_t foreign_tuples = 0; ///< tuples that are none of these: dropped
  std::uint64_t motes_refused = 0;  ///< percepts of motes beyond motes_max: dropped
};
RUBICON_FIELDS(manager_counters, started, stopped, bad_lists, bad_types, bad_statuses,
               foreign_tuples, motes_refused);

/// Starts one proxy for every listed mote whose type a class claims, and notifies proxies whether
/// their motes are there (PXY-09, 10, 15, 16). A percept consumed by a running proxy starts none:
/// proxies map one-to-one to motes, so the mote's address decides.
///
/// List and type come in any order. A proxy outlives the absence of its mote and of its gateway,
/// and keeps its class when the class table changes; it is stopped only when its mote reports a
/// type of another class.
class manager {
public:
  using output = std::variant<start_proxy, stop_proxy, set_presence, unknown_type>;
  using outputs = std::vector<output>;

  explicit manager(class_table classes = {}, std::size_t motes_max = 65536)
      : classes_(std::move(classes)), motes_max_(motes_max) {}

  /// A tuple of an island's gateway has a new value: on_devices(), on_type() or on_status(), by its
  /// key.
  [[nodiscard]] outputs on_gateway_tuple(island_id island, std::string_view key, byte_view value,
                                         instant now);

  /// The gateway's list of motes, `{1,7,11}`; a malformed one is dropped and changes nothing.
  [[nodiscard]] outputs on_devices(island_id island, std::string_view text, instant now);

  /// A mote's type, 4 octets.
  [[nodiscard]] outputs on_type(island_id island, mote_id mote, byte_view octets, instant now);

  /// What the gateway knows of a mote.
  [[nodiscard]] outputs on_status(island_id island, mote_id mote, std::string_view text,
                                  instant now);

  /// The gateway has left the ecology, or its list was deleted: its motes are out of reach.
  [[nodiscard]] outputs on_gateway_gone(island_id island, instant now);

  /// Other latent classes; motes without a proxy are looked up again (PXY-10).
  [[nodiscard]] outputs on_classes(class_table classes, instant now);

  /// A proxy has ended by itself: retired or failed. If its mote is there a new one is started.
  [[nodiscard]] outputs on_proxy_gone(const mote_address& mote, instant now);

  [[nodiscard]] const class_table& classes() const { return classes_; }
  [[nodiscard]] const manager_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t running() const;
  /// Class of the mote's proxy; nothing if none runs.
  [[nodiscard]] std::optional<std::string> running_class(const mote_address& mote) const;

private:
  struct known_mote {
    bool listed = false;
    std::optional<std::uint32_t> type;
    std::optional<std::uint32_t> reported; ///< newest type reported as unknown
    std::optional<std::string> class_name; ///< of its proxy, while it runs
    std::uint32_t class_type = 0;          ///< type for which the class was chosen
    bool stale = false;
    std::string left_cause; ///< as its gateway says, before or after it is no longer listed
    std::string cause;      ///< why it is not listed
    device_presence reported_presence = device_presence::left; ///< the last one sent to its proxy,
    std::string reported_cause;                                ///< and its cause
  };

  [[nodiscard]] known_mote* know(const mote_address& mote);
  void unlist(const mote_address& mote, known_mote& x, std::string cause, outputs& out);
  void update(const mote_address& mote, known_mote& x, outputs& out);
  void report_presence(const mote_address& mote, known_mote& x, outputs& out);
  void follow_type(const mote_address& mote, known_mote& x, outputs& out);

  class_table classes_;
  std::size_t motes_max_;
  std::map<mote_address, known_mote> motes_;
  manager_counters counters_;
};

} // namespace rubicon::proxy
