#include <string>

#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

constexpr std::string_view here = "bluetooth = [\"hci0\"]\nposition_m = [1, 2]\n";

} // namespace

TEST_CASE("nothing has Bluetooth by default, and its link is slow and short", "[config][BT-02]") {
  const auto x = good(std::string(head));
  CHECK(x.peers.at(0).bluetooth.empty());
  CHECK(x.peers.at(0).wired);
  CHECK(x.bluetooth_devices.empty());
  CHECK(x.peis.bluetooth.range_m == 10);
  CHECK(x.peis.bluetooth.rate_bps == 8 * 2000);
  CHECK(x.peis.bluetooth.scan_period == 10s);
  CHECK(x.peis.bluetooth.threshold_dbm == -67);
  CHECK_FALSE(x.peis.bluetooth.takeover);
  CHECK(summary(x).find("bluetooth") == std::string::npos);
}

TEST_CASE("the keys of Bluetooth arrive", "[config][BT-01][BT-03]") {
  const auto x = good(std::string(head) +
                      "bluetooth = [\"hci0\", \"hci12\"]\nposition_m = [1, 2, 3]\nwired = false\n"
                      "[peis.bluetooth]\nrange = \"25m\"\nrate = \"80kbit/s\"\n"
                      "scan_period = \"5s\"\nrssi_threshold = \"-70dBm\"\ntakeover = true\n"
                      "[[bluetooth_device]]\nname = \"phone\"\naddress = \"00:1b:44:11:3A:B7\"\n"
                      "position_m = [4, 5]\n"
                      "[[fault]]\nat = \"1s\"\nkind = \"move\"\npeer = \"*\"\nto_m = [7, 8]\n");
  const auto& peer = x.peers.at(0);
  CHECK(peer.bluetooth == std::vector<std::string>{"hci0", "hci12"});
  CHECK(peer.place == position{1, 2, 3});
  CHECK_FALSE(peer.wired);
  CHECK_FALSE(peer.discovery);
  CHECK(x.peis.bluetooth.range_m == 25);
  CHECK(x.peis.bluetooth.rate_bps == 80'000);
  CHECK(x.peis.bluetooth.scan_period == 5s);
  CHECK(x.peis.bluetooth.threshold_dbm == -70);
  CHECK(x.peis.bluetooth.takeover);
  REQUIRE(x.bluetooth_devices.size() == 1);
  CHECK(x.bluetooth_devices[0].name == "phone");
  CHECK(to_string(x.bluetooth_devices[0].address) == "00:1B:44:11:3A:B7");
  CHECK(x.bluetooth_devices[0].place == position{4, 5, 0});
  const auto& fault = std::get<move_fault>(x.faults.at(0).what);
  CHECK(fault.peer == any_peer);
  CHECK(fault.to == position{7, 8, 0});
  const auto text = summary(x);
  CHECK(text.find("bluetooth: range 25 m; 80 kbit/s; scan every 5 s; links from -70 dBm; takeover; "
                  "1 other device\n") != std::string::npos);
  CHECK(text.find("bluetooth hci0, hci12; not wired") != std::string::npos);
  CHECK(text.find("move  any peer to [7, 8]") != std::string::npos);
}

TEST_CASE("Bluetooth that cannot be is refused", "[config][GEN-06][BT-01]") {
  const auto device = [](const std::string& address, const std::string& name) {
    return "[[bluetooth_device]]\nposition_m = [0, 0]\naddress = \"" + address + "\"\nname = \"" +
           name + "\"\n";
  };
  const std::string phone = "00:1B:44:11:3A:B7";
  const auto first_line = [](const std::string& keys) { return problem_after(head, keys); };
  CHECK(first_line(std::string(here)) == "none");
  CHECK(first_line("bluetooth = [\"hci0\"]\n") == "6:13: `bluetooth` needs a `position_m`");
  CHECK(first_line("position_m = [1, 2]\n") ==
        "6:14: `position_m` has no effect without `bluetooth`");
  CHECK(first_line("bluetooth = [\"eth0\"]\nposition_m = [1, 2]\n")
            .starts_with("6:14: `bluetooth` must be the name of a Bluetooth adapter"));
  CHECK(first_line("bluetooth = [\"hci0\", \"hci0\"]\nposition_m = [1, 2]\n") ==
        "6:22: the adapter `hci0` is already listed (line 6, column 14)");
  CHECK(first_line("wired = false\n") == "6:9: without `bluetooth` it would have no links at all");
  CHECK(first_line(std::string(here) +
                   "wired = false\nlinks = [\"inproc://b\"]\n[[peer]]\nname = \"b\"\nid = 301\n")
            .ends_with("`links` need `wired = true`"));
  CHECK(first_line(device("00:1B:44:11:3A", "phone"))
            .starts_with("8:11: `address` must be the address of a Bluetooth device"));
  CHECK(first_line(device(phone, "a") + device(phone, "b")) ==
        "12:11: Bluetooth address " + phone + " is already taken (line 8, column 11)");
  CHECK(first_line("host = \"h\"\n" + std::string(here) +
                   "[[peer]]\nname = \"b\"\nid = 301\nhost = \"h\"\nbluetooth = [\"hci0\"]\n"
                   "position_m = [3, 4]\n[[host]]\nname = \"h\"\naddress = \"a\"\n") ==
        "14:14: the peers of host `h` share its adapters: they must have the same position");
}

TEST_CASE("a real adapter is for wall time", "[config][BT-01]") {
  const std::string wall =
      "[ecology]\nname = \"t\"\nmode = \"wall\"\n[[peer]]\nname = \"pc\"\nid = 300\n";
  const std::string adapter = "bluetooth = { adapter = \"hci0\" }\n";
  const auto x = good(wall + adapter + "connect = [\"bt://00:1b:44:11:3A:B7;8193\"]\n");
  CHECK(x.peers.at(0).adapter == "hci0");
  CHECK(x.peers.at(0).bluetooth.empty());
  CHECK(x.peers.at(0).connect == std::vector<std::string>{"bt://00:1b:44:11:3A:B7;8193"});
  CHECK(has_real_links(x.peers.at(0)));
  CHECK(summary(x).find("real bluetooth hci0") != std::string::npos);
  CHECK(good(wall).peers.at(0).adapter.empty());
  CHECK_FALSE(has_real_links(good(wall).peers.at(0)));
  CHECK(problem_after(head, adapter) ==
        "6:13: an `adapter` needs mode = \"wall\": in virtual time there is no real Bluetooth");
  const auto refused = [&](const std::string& keys) { return problem_after(wall, keys); };
  CHECK(refused(adapter) == "none");
  CHECK(refused(adapter + "wired = false\n") == "none");
  CHECK(refused("bluetooth = {}\n").ends_with("`adapter` is missing in [peer.bluetooth]"));
  CHECK(refused("bluetooth = { adapter = \"eth0\" }\n")
            .find("must be the name of a Bluetooth adapter") != std::string::npos);
  CHECK(refused(adapter + "position_m = [1, 2]\n")
            .ends_with("`position_m` has no effect with a real adapter"));
  CHECK(refused("connect = [\"bt://00:1B:44:11:3A:B7;8193\"]\n")
            .ends_with("needs `bluetooth = { adapter = \"hci0\" }`"));
  CHECK(refused(adapter + "connect = [\"bt://00:1B:44:11:3A:B7\"]\n")
            .ends_with("give the port of the peer's links, as in `bt://00:1B:44:11:3A:B7;8193`"));
}
