#include "deploy/host_access.hpp"

#include <algorithm>

#include "config/load.hpp"
#include "support/catch.hpp"
#include "support/elf_file.hpp"

using namespace rubicon;

namespace {

/// What is said against a file, on a host that allows so much.
std::string said_of(const std::string& toml, const deploy::host_access& access = {}) {
  const auto loaded = config::load_text(
      "[ecology]\nname = \"x\"\nmode = \"wall\"\n" + toml, "x.toml", {},
      [](const std::string& path, std::size_t) {
        return path == "wall.so" ? config::file_text{to_string(test::elf_file(1, 1)), ""}
                                 : config::file_text{std::nullopt, "none"};
      },
      [](const std::string&) {
        return config::folder_names{std::nullopt, "none"};
      },
      {});
  for (const auto& each : loaded.problems)
    FAIL(to_string(each));
  std::string all;
  for (const auto& each : deploy::refusals(*loaded.ecology, access))
    all += each + '\n';
  return all;
}

std::string recorder(const std::string& path) {
  return "[[peer]]\nid = 40\nname = \"pc\"\napps = [{ app = \"recorder\", streams = [1], file = "
         "\"" +
         path + "\" }]\n";
}

std::string island(const std::string& serial) {
  return "[[island]]\nid = 1\nname = \"kitchen\"\nserial = { " + serial + " }\n";
}

} // namespace

TEST_CASE("a path is inside of a folder by its text alone", "[deploy]") {
  for (const auto* good : {"a", "a.csv", "a/b.csv", "..a", "a..", ".bashrc"})
    CHECK(deploy::is_inside(good));
  for (const auto* bad : {"", "/", "/a", "..", "../a", "a/../b", "a/..", "./a", "a//b", "a/"})
    CHECK_FALSE(deploy::is_inside(bad));
  CHECK_FALSE(deploy::is_inside(std::string_view("a\0b", 3)));
}

TEST_CASE("devices are those of a host's patterns", "[deploy]") {
  const std::vector<std::string> usb{"/dev/ttyUSB?", "/dev/serial/*/if00"};
  CHECK(deploy::is_allowed("/dev/ttyUSB0", usb));
  CHECK(deploy::is_allowed("/dev/serial/by-id/a/if00", usb));
  for (const auto* other : {"/dev/ttyUSB", "/dev/ttyUSB10", "/dev/ttyS0", "", "/dev/serial/if00x",
                            "/dev/serial/../../etc/if00"})
    CHECK_FALSE(deploy::is_allowed(other, usb));
  CHECK(deploy::is_allowed("/dev/anything", {"*"}));
  CHECK_FALSE(deploy::is_allowed("/dev/anything", {}));
}

TEST_CASE("recorders write inside of the part's folder", "[deploy][security]") {
  CHECK(said_of(recorder("readings/a.csv")).empty());
  for (const auto* path : {"/home/x/.bashrc", "../../.ssh/authorized_keys", "a/../../b"})
    CHECK(said_of(recorder(path)).find("outside the part's folder") != std::string::npos);
}

TEST_CASE("serial ports and pseudo-terminals are those that the host allows",
          "[deploy][security]") {
  CHECK(said_of(island("pty = \"sink\"")).empty());
  CHECK(said_of(island("pty = \"/home/x/.profile\"")).find("--allow-devices") != std::string::npos);
  CHECK(said_of(island("pty = \"../sink\"")).find("--allow-devices") != std::string::npos);
  const auto port = island("device = \"/dev/ttyUSB0\"");
  CHECK(said_of(port).find("/dev/ttyUSB0 is not among the devices") != std::string::npos);
  CHECK(said_of(port, {false, {"/dev/ttyUSB*"}}).empty());
}

TEST_CASE("Bluetooth adapters are those that the host allows", "[deploy][security]") {
  const auto adapter = "[[peer]]\nid = 40\nname = \"pc\"\nbluetooth = { adapter = \"hci0\" }\n";
  CHECK(said_of(adapter).starts_with("peer `pc`: hci0 is not among the devices"));
  CHECK_FALSE(said_of(adapter, {false, {"hci1", "/dev/ttyUSB*"}}).empty());
  CHECK(said_of(adapter, {false, {"/dev/ttyUSB*", "hci0"}}).empty());
  CHECK(said_of(adapter, {false, {"hci?"}}).empty());
}

TEST_CASE("commands and locks of an init are the host's to allow", "[deploy][security]") {
  const auto init = [](const std::string& more) {
    return "[[peer]]\nid = 41\nname = \"init\"\napps = [{ app = \"init\", components = [{ name = "
           "\"tool\", id = 50, command = \"true\" }]" +
           more + " }]\n";
  };
  CHECK(said_of(init("")).find("--allow-commands") != std::string::npos);
  CHECK(said_of(init(""), {true, {}}).empty());
  CHECK(said_of(init(", lock = \"/etc/passwd\""), {true, {}}).find("outside the part's folder") !=
        std::string::npos);
}

TEST_CASE("firmware of a deployed file runs only on a host that allows it", "[deploy][firmware]") {
  const std::string mote = "[[island]]\nid = 1\nname = \"kitchen\"\nstack = \"mac\"\n"
                           "[[island.mote]]\nid = 2\nname = \"a\"\nposition_m = [1, 1]\n";
  const auto flooder = mote + "firmware = \"wall.so\"\n";
  CHECK(said_of(flooder).find("--allow-firmware") != std::string::npos);
  CHECK(said_of(flooder, {false, {}, true}).empty());
  CHECK(said_of(mote).empty());
}
