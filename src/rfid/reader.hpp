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
#include "core/component.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "device/walk.hpp"
#include "rfid/reader_config.hpp"

namespace rubicon::rfid {

/// A passive tag, and the thing that it sticks to.
struct tag {
  std::string id;    ///< its hardware id: 1 to 32 lower-case letters, digits, - and _
  bytes memory;      ///< its user memory, which readers read
  device::walk walk; ///< where it is, and is carried. @pre not empty
};

using tags = std::vector<tag>;

using components::erase;
using components::output;
using components::outputs;
using components::publish;

/// Publishes what it perceives, in the tuples of core/tuples/interface_keys.hpp, and interprets
/// nothing.
class reader final : public components::component {
public:
  reader() = default;
  /// @param world shared by all readers, never null
  reader(reader_config config, std::shared_ptr<const tags> world, random_stream rng);

  [[nodiscard]] outputs start(instant now) override;
  [[nodiscard]] outputs on_time(instant now) override; ///< an inventory
  [[nodiscard]] std::optional<instant> deadline() const override { return due_; }

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
  random_stream rng_;
  std::map<std::string, sight> seen_;
  std::optional<instant> due_;
};

} // namespace rubicon::rfid
