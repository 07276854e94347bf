#include <string>

#include "peis/bluetooth/hci_inquiry.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::peis;

namespace {

inquiry_event decoded(const std::string& hex) {
  return decode_inquiry_event(*from_hex(hex));
}

/// `02:4B:00:1F:A0:07 -60`, ...
std::string devices(const std::string& hex) {
  const auto event = decoded(hex);
  const auto* all = std::get_if<std::vector<seen_device>>(&event);
  REQUIRE(all != nullptr);
  std::string text;
  for (const auto& x : *all)
    text +=
        (text.empty() ? "" : ", ") + to_string(x.address) + ' ' + std::to_string(x.strength_dbm);
  return text;
}

/// "succeeded", "failed" or "goes on"
std::string ending(const std::string& hex) {
  const auto event = decoded(hex);
  const auto* ended = std::get_if<inquiry_ended>(&event);
  if (ended == nullptr)
    return "goes on";
  return ended->success ? "succeeded" : "failed";
}

const std::string robot = "07a01f004b02"; // on the wire the last octet is first
const std::string phone = "010000000002";

} // namespace

TEST_CASE("the inquiry command is that of the specification", "[peis][BT-04]") {
  // As `hcitool cmd 0x01 0x0001 33 8b 9e 08 00` has it.
  CHECK(to_hex(inquiry_command(10240ms)) == "01010405338b9e0800");
  CHECK(inquiry_command(5s)[7] == 3);
  CHECK(inquiry_command(0s)[7] == 1);
  CHECK(inquiry_command(1h)[7] == 48);
}

TEST_CASE("results of an inquiry have address and strength", "[peis][BT-04]") {
  const auto result = [](const std::string& address, const std::string& rssi) {
    return address + "01" + "00" + "04025a" + "1234" + rssi;
  };
  CHECK(devices("04220f01" + result(robot, "c4")) == "02:4B:00:1F:A0:07 -60");
  CHECK(devices("04221d02" + result(robot, "c4") + result(phone, "05")) ==
        "02:4B:00:1F:A0:07 -60, 02:00:00:00:00:01 5");
  // Old adapters add an octet before the class of the device.
  CHECK(devices("04221001" + robot + "01" + "00" + "00" + "04025a" + "1234" + "80") ==
        "02:4B:00:1F:A0:07 -128");
  CHECK(devices("042fff01" + result(robot, "d0") + std::string(480, '0')) ==
        "02:4B:00:1F:A0:07 -48");
}

TEST_CASE("an inquiry ends, or is refused", "[peis][BT-04]") {
  CHECK(ending("04010100") == "succeeded");
  CHECK(ending("0401010c") == "failed");
  CHECK(ending("040f0401010104") == "failed");
  CHECK(ending("040f040c010104") == "goes on"); // of another program, whose results come
  CHECK(ending("040f0400010104") == "goes on"); // begun
  CHECK(ending("040f040c010504") == "goes on"); // another command
}

TEST_CASE("other packets of an adapter, and broken ones, say nothing", "[peis][BT-04][GEN-06]") {
  for (const auto* hex : {"", "04", "0401", "040100", "04010200", "02010100", "04220100",
                          "0422020100", "042200", "04220f0207a01f004b02010004025a1234c4",
                          "0413050101000100", "042f020100", "04020f0107a01f004b0201000004025a1234"})
    CHECK(devices(hex).empty());
  bytes any(258, 1);
  for (std::size_t code = 0; code < 256; ++code) {
    any[0] = 4;
    any[1] = static_cast<std::uint8_t>(code);
    for (std::size_t size = 0; size <= any.size(); ++size) {
      any[2] = static_cast<std::uint8_t>(size < 3 ? 0 : size - 3);
      static_cast<void>(decode_inquiry_event(byte_view(any).first(size)));
    }
  }
}
