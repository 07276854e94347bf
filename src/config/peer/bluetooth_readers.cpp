// [peis.bluetooth], [[bluetooth_device]], and what a peer has of Bluetooth.
#include <algorithm>
#include <utility>

#include "config/file_readers.hpp"
#include "config/peer/peer_keys.hpp"
#include "peis/bluetooth/bluetooth.hpp"
#include "peis/wire/link_url.hpp"

namespace rubicon::config {

namespace {

constexpr std::size_t adapters_max = 4;
constexpr std::size_t adapter_name_max = 8; // docs/peis-wire.md 5

/// "hci0"
struct adapter_name {
  using type = std::string;

  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who) {
    constexpr std::string_view prefix = "hci";
    const auto* found = x.as<std::string>();
    const bool good = found != nullptr && found->size() > prefix.size() &&
                      found->size() <= adapter_name_max && found->starts_with(prefix) &&
                      std::all_of(found->begin() + prefix.size(), found->end(),
                                  [](char c) { return c >= '0' && c <= '9'; });
    return good ? std::optional(*found)
                : who.refuse(x, "the name of a Bluetooth adapter, as in \"hci0\"");
  }
  [[nodiscard]] static form takes() { return string_form("adapter, `\"hci0\"`"); }
};

/// "00:1B:44:11:3A:B7"
struct device_address {
  using type = peis::bluetooth_address;

  [[nodiscard]] static std::optional<peis::bluetooth_address> read(const node& x,
                                                                   const asker& who) {
    const auto* found = x.as<std::string>();
    const auto address = peis::parse_bluetooth_address(found == nullptr ? "" : *found);
    if (!address)
      return who.refuse(x, "the address of a Bluetooth device, as in \"00:1B:44:11:3A:B7\"");
    return *address;
  }
  [[nodiscard]] static form takes() { return string_form("text `\"00:1B:44:11:3A:B7\"`"); }
};

/// What has `key` cannot run without Bluetooth (LNK-04).
void need_bluetooth(const table_reader& in, std::string_view key) {
  if (in.has(key) && !peis::has_bluetooth())
    in.problems().add(in.at(key), "this rubicon was built without Bluetooth; "
                                  "build it with -DRUBICON_BLUETOOTH=ON");
}

auto real_adapter_keys() {
  return keys::of(
      keys::required("adapter", &peer_description::adapter, adapter_name{},
                     "real Bluetooth adapter of its computer that it uses; needs `mode = "
                     "\"wall\"`"));
}

constexpr about bluetooth_meaning = {
    "adapters of its computer that it uses, in simulation; peers of one host share them, and the "
    "first to start announces all of them. A table: a real adapter",
    "none"};

/// Simulated adapters, with the places that checks need.
struct adapter_list {
  std::vector<located<std::string>> names;
};

constexpr list_of<adapter_name> adapter_names{{}, 1, adapters_max};

auto keys_of(const adapter_list*) {
  return keys::of(
      keys::optional("bluetooth", &adapter_list::names, adapter_names, bluetooth_meaning));
}

auto device_keys() {
  return keys::of(
      keys::required("name", &bluetooth_device::name, name_text{}, "no other device has it"),
      keys::required("address", &bluetooth_device::address, device_address{},
                     "no other device has it"),
      keys::required("position_m", &bluetooth_device::place, place{}, "where it is"));
}

/// bluetooth = ["hci0"], or bluetooth = { adapter = "hci0" }
void read_adapter_names(table_reader& in, peer_description& out) {
  const auto* given = in.content().find("bluetooth");
  if (given == nullptr || given->as<node_table>() != nullptr) {
    in.table("bluetooth", "[peer.bluetooth]", bluetooth_meaning,
             [&out](table_reader& x) { x.all(out, real_adapter_keys()); });
    in.instead_of_table("bluetooth", adapter_names);
    return;
  }
  adapter_list adapters;
  in.all(adapters);
  uniqueness<std::string> named;
  for (const auto& each : adapters.names)
    named.add(each.value, "the adapter `" + each.value + '`', each.at, in.problems(),
              "is already listed");
  out.bluetooth = values_of(std::move(adapters.names));
}

/// A real adapter is there in wall time only, and `bt://` addresses need one.
void check_real_adapter(const table_reader& in, run_mode mode, const peer_description& x) {
  if (mode == run_mode::virtual_time && !x.adapter.empty())
    in.problems().add(in.at("bluetooth"), "an `adapter` needs mode = \"wall\": in virtual time "
                                          "there is no real Bluetooth");
  for (const auto& each : x.connect) {
    const auto url = peis::parse_link_url(each);
    if (mode == run_mode::virtual_time || !url || !peis::bluetooth_device(*url))
      continue;
    if (x.adapter.empty())
      in.problems().add(in.at("connect"),
                        '`' + each + "` needs `bluetooth = { adapter = \"hci0\" }`");
    else if (url->port == peis::hello_port)
      in.problems().add(in.at("connect"), '`' + each +
                                              "` is where HELLOs arrive: give the port of the "
                                              "peer's links, as in `bt://" +
                                              url->host + ";8193`");
  }
}

/// What a place is for.
void check_place(const table_reader& in, const peer_description& x) {
  const bool is_simulated = in.has("bluetooth") && x.adapter.empty() &&
                            in.content().find("bluetooth")->as<node_table>() == nullptr;
  if (is_simulated && !in.has("position_m"))
    in.problems().add(in.at("bluetooth"), "`bluetooth` needs a `position_m`");
  if (in.has("position_m") && !in.has("bluetooth"))
    in.problems().add(in.at("position_m"), "`position_m` has no effect without `bluetooth`");
  if (in.has("position_m") && in.has("bluetooth") && !is_simulated)
    in.problems().add(in.at("position_m"), "`position_m` has no effect with a real adapter");
}

} // namespace

void read_bluetooth(table_reader& in, bluetooth_description& out) {
  need_bluetooth(in, "bluetooth");
  in.table("bluetooth", "[peis.bluetooth]",
           {"simulated Bluetooth between the adapters of peers", "see there"},
           [&out](table_reader& x) { x.all(out); });
}

std::vector<bluetooth_device> read_bluetooth_devices(table_reader& root) {
  need_bluetooth(root, "bluetooth_device");
  std::vector<bluetooth_device> out;
  name_uniqueness names;
  uniqueness<peis::bluetooth_address> addresses;
  root.tables("bluetooth_device", "[[bluetooth_device]]",
              "devices with Bluetooth that are not peers", [&](table_reader& in) {
                bluetooth_device x;
                in.all(x, device_keys());
                if (in.is_good("name"))
                  names.add(x.name, "device name", in.at("name"), in.problems());
                if (in.is_good("address"))
                  addresses.add(x.address, "Bluetooth address " + to_string(x.address),
                                in.at("address"), in.problems());
                out.push_back(std::move(x));
              });
  return out;
}

void read_adapters(table_reader& in, run_mode mode, machine_places& places, peer_description& out) {
  need_bluetooth(in, "bluetooth");
  read_adapter_names(in, out);
  in.all(out, peer_place_keys());
  check_place(in, out);
  check_real_adapter(in, mode, out);
  const bool meets_others = in.has("bluetooth") || !out.connect.empty() || out.tcp || out.lan;
  if (!out.wired && !meets_others)
    in.problems().add(in.at("wired"), "without `bluetooth` it would have no links at all");
  if (!out.wired && !out.links.empty())
    in.problems().add(in.at("links"), "`links` need `wired = true`");
  out.discovery = out.discovery && out.wired;
  if (!in.is_good("position_m") || out.host.empty())
    return;
  const auto [known, is_new] = places.emplace(out.host, out.place);
  if (!is_new && known->second != out.place)
    in.problems().add(in.at("position_m"),
                      "the peers of host `" + out.host +
                          "` share its adapters: they must have the same position");
}

} // namespace rubicon::config
