// A world of tagged things, and the readers that perceive them (D1.1 3.2.2; PXY-02, PXY-03): the
// interface of objects that have neither radio stack nor programs.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/random.hpp"
#include "core/time.hpp"
#include "mote/walk.hpp"
#include "rfid/reader_config.hpp"

namespace rubicon::rfid {

/// A passive tag, and the thing that it sticks to.
struct tag {
  std::string id; ///< its hardware id: 1 to 32 lower-case letters, digits, - and _
  bytes memory;   ///< its user memory, which readers read
  mote::walk way; ///< where it is, and is carried. @pre not empty
};

using tags = std::vector<tag>;

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

using output = std::variant<publish, erase>;
using outputs = std::vector<output>;

/// Publishes what it perceives, in the tuples of core/interface_keys.hpp, and interprets nothing.
class reader {
public:
  reader() = default;
  /// @param world shared by all readers, never null
  reader(reader_config config, std::shared_ptr<const tags> world, random_stream dice);

  [[nodiscard]] outputs start(instant now);
  [[nodiscard]] outputs on_time(instant now); ///< an inventory; harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const { return due_; }

  [[nodiscard]] std::size_t perceived() const { return seen_.size(); }

private:
  struct sight {
    unsigned missed = 0; ///< inventories in succession
    double rssi_dbm = 0; ///< as published
  };

  [[nodiscard]] std::optional<double> strength(const tag& x, instant now);
  [[nodiscard]] publish list() const;

  reader_config config_;
  std::shared_ptr<const tags> world_;
  random_stream dice_;
  std::map<std::string, sight> seen_;
  std::optional<instant> due_;
};

} // namespace rubicon::rfid
