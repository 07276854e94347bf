// In the place of bluetooth.cpp in a build without Bluetooth (LNK-04): a kernel without adapters.
#include "peis/bluetooth/bluetooth.hpp"

namespace rubicon::peis {

bool has_bluetooth() {
  return false;
}

bluetooth::bluetooth(bluetooth_config /*config*/, instant /*now*/) {}

bluetooth::outputs bluetooth::on_time(instant /*now*/) {
  return {};
}

std::optional<instant> bluetooth::deadline() const {
  return std::nullopt;
}

bluetooth::outputs bluetooth::on_scan(std::string_view /*adapter*/,
                                      std::span<const seen_device> /*seen*/, instant /*now*/) {
  return {};
}

bluetooth::outputs bluetooth::on_answer(std::string_view /*adapter*/,
                                        const bluetooth_address& /*address*/, bool /*is_peer*/,
                                        instant /*now*/) {
  return {};
}

bool bluetooth::is_connectable(const bluetooth_address& /*address*/) const {
  return false;
}

std::optional<bluetooth::standing>
bluetooth::standing_of(std::string_view /*adapter*/, const bluetooth_address& /*address*/) const {
  return std::nullopt;
}

} // namespace rubicon::peis
