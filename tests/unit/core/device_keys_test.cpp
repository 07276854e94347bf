#include <string>
#include <utility>
#include <vector>

#include "core/tuples/device_keys.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

std::vector<mote_id> motes(std::initializer_list<int> ids) {
  std::vector<mote_id> list;
  for (const auto id : ids)
    list.emplace_back(static_cast<std::uint16_t>(id));
  return list;
}

} // namespace

TEST_CASE("device keys read as D1.1 5.4 writes them", "[core][GW-03][GW-04][GW-05][GW-06][GW-07]") {
  CHECK(devices_key == "devices");
  CHECK(device_type_key(mote_id{7}) == "devices.7.type");
  CHECK(device_descriptor_key(mote_id{7}) == "devices.7.descriptor");
  CHECK(device_input_key(mote_id{7}, 0) == "devices.7.input.0");
  CHECK(device_output_key(mote_id{7}, 65535) == "devices.7.output.65535");
  CHECK(device_input_status_key(mote_id{65532}, 12) == "devices.65532.input.12.status");
  CHECK(device_output_period_key(mote_id{7}, 2) == "devices.7.output.2.period");
  CHECK(device_status_key(mote_id{7}) == "devices.7.status");
  CHECK(to_string(device_key{device_tuple::line, {}, 0}) == "devices.line");
}

TEST_CASE("every device key comes back from its text", "[core][GW-07]") {
  for (const auto what : {device_tuple::list, device_tuple::type, device_tuple::descriptor,
                          device_tuple::output, device_tuple::input, device_tuple::input_status})
    for (const auto mote : std::vector<std::uint16_t>{1, 7, 65532})
      for (const auto channel : std::vector<std::uint16_t>{0, 1, 10, 65535}) {
        const bool has_mote = what != device_tuple::list;
        const bool has_channel = what == device_tuple::output || what == device_tuple::input ||
                                 what == device_tuple::input_status;
        const device_key key{what, mote_id{has_mote ? mote : std::uint16_t{0}},
                             has_channel ? channel : std::uint16_t{0}};
        const auto parsed = parse_device_key(to_string(key));
        REQUIRE(parsed);
        CHECK(*parsed == key);
      }
}

TEST_CASE("letter case does not distinguish device keys", "[core][GW-07][TUP-03]") {
  const auto key = parse_device_key("DEVICES.7.Input.3.STATUS");
  REQUIRE(key);
  CHECK(*key == device_key{device_tuple::input_status, mote_id{7}, 3});
}

TEST_CASE("a key that is not exactly a device key is refused", "[core][GW-07]") {
  const auto* const key = GENERATE(
      "", ".", "device", "devices.", "devices.7", "devices.7.", "devices..type", "devices.00.type",
      "devices.07.type", "devices.65533.type", "devices.65536.type", "devices.4294967303.type",
      "devices.-7.type", "devices.+7.type", "devices.7x.type", "devices. 7.type", "devices.7.types",
      "devices.7.type.", "devices.7.type.0", "devices.*.type", "devices.7.input",
      "devices.7.input.", "devices.7.input.00", "devices.7.input.01", "devices.7.input.65536",
      "devices.7.input.-1", "devices.7.input.*", "devices.7.output.1.status",
      "devices.7.input.1.state", "devices.7.input.1.status.x", "devices.7.input.1.status.x.y.z",
      "xdevices.7.type", "devices.7.descriptor.1");
  const auto parsed = parse_device_key(key);
  CAPTURE(key);
  REQUIRE_FALSE(parsed);
  CHECK(parsed.error() == errc::bad_value);
}

TEST_CASE("the device list is ascending text in braces", "[core][GW-03]") {
  CHECK(device_list_text({}) == "{}");
  CHECK(device_list_text(motes({7})) == "{7}");
  CHECK(device_list_text(motes({11, 1, 7, 1})) == "{1,7,11}");
  for (const auto& list : {motes({}), motes({1}), motes({1, 7, 11}), motes({1, 65532})}) {
    const auto parsed = parse_device_list(device_list_text(list));
    REQUIRE(parsed);
    CHECK(*parsed == list);
  }
}

TEST_CASE("a device list that is not exactly one is refused", "[core][GW-03]") {
  const auto* const text =
      GENERATE("", "{", "}", "1,7", "{1,7", "1,7}", "{,}", "{1,}", "{,1}", "{1,,7}", "{ 1}",
               "{1, 7}", "{7,1}", "{1,1}", "{00}", "{01}", "{65533}", "{65537}", "{-1}", "{+1}",
               "{a}", "{1}}", "{{1}", "{1} ", "(1)", "{1;7}");
  CAPTURE(text);
  CHECK_FALSE(parse_device_list(text));
}

TEST_CASE("a type is 4 octets, most significant first", "[core][GW-04][GW-11]") {
  CHECK(device_type_octets(42) == bytes{0, 0, 0, 0x2a});
  CHECK(*parse_device_type(bytes{0x01, 0x02, 0x03, 0x04}) == 0x01020304);
  CHECK(parse_device_type(bytes{}).error() == errc::truncated);
  CHECK(parse_device_type(bytes{0, 0, 42}).error() == errc::truncated);
  CHECK(parse_device_type(bytes{0, 0, 0, 42, 0}).error() == errc::too_long);
}

TEST_CASE("the status of an input is a number and a word", "[core][GW-12]") {
  const std::vector<std::pair<input_status, std::string>> table{
      {{1, input_outcome::pending}, "1 pending"},
      {{2, input_outcome::acknowledged}, "2 acknowledged"},
      {{10, input_outcome::failed}, "10 failed"},
      {{11, input_outcome::sent}, "11 sent"},
      {{18446744073709551615ULL, input_outcome::unreachable}, "18446744073709551615 unreachable"}};
  for (const auto& [status, text] : table) {
    CHECK(to_string(status) == text);
    const auto parsed = parse_input_status(text);
    REQUIRE(parsed);
    CHECK(*parsed == status);
  }
}

TEST_CASE("a status that is not exactly a number and a word is refused", "[core][GW-12]") {
  const auto* const text =
      GENERATE("", " ", "1", "pending", "1 ", " pending", "1  pending", "0 pending", "01 pending",
               "-1 pending", "1 Pending", "1 pending ", "1 done", "18446744073709551616 failed");
  CAPTURE(text);
  CHECK_FALSE(parse_input_status(text));
}

TEST_CASE("the text of a tuple ends before its NUL", "[core][TUP-02]") {
  CHECK(tuple_text(bytes{'{', '1', '}', 0}) == "{1}");
  CHECK(tuple_text(bytes{'{', '1', '}'}) == "{1}");
  CHECK(tuple_text(bytes{'a', 0, 'b', 0}) == "a");
  CHECK(tuple_text(bytes{0}).empty());
  CHECK(tuple_text(bytes{}).empty());
}

TEST_CASE("a mote's status has presence, cause and since when", "[core][GW-15][IF-13]") {
  const device_status listed{device_presence::listed, {}, instant{12s}};
  const device_status left{device_presence::left, "out_of_range", instant{345100ms}};
  CHECK(to_string(listed) == "listed 12.000000");
  CHECK(to_string(left) == "left out_of_range 345.100000");
  CHECK(*parse_device_status(to_string(listed)) == listed);
  CHECK(*parse_device_status(to_string(left)) == left);
  CHECK(*parse_device_status("stale 0.000000") == device_status{device_presence::stale, {}, {}});
  for (const auto* text :
       {"", "listed", "listed ", "listed 1", "listed 1.0", "listed  1.000000", "here 1.000000",
        "left 1.000000", "left  1.000000", "left a b 1.000000", "listed silence 1.000000",
        "listed -1.000000", "listed 01.000000", "listed 99999999999.000000", "listed 1.00000x"})
    CHECK(!parse_device_status(text));
}

TEST_CASE("an output's period is in whole milliseconds", "[core][IF-04]") {
  CHECK(*parse_output_period("250") == 250ms);
  CHECK(*parse_output_period("0") == 0ms);
  for (const auto* text : {"", "-1", "1.5", "250ms", "4294967296", "007"})
    CHECK(!parse_output_period(text));
}

TEST_CASE("a pattern names outputs of one mote or all, on one channel or all",
          "[core][GW-10][IF-04]") {
  CHECK(*parse_output_pattern("devices.7.output.2") == output_pattern{mote_id{7}, 2});
  CHECK(*parse_output_pattern("Devices.*.output.2") == output_pattern{std::nullopt, 2});
  CHECK(*parse_output_pattern("devices.7.*.*") == output_pattern{mote_id{7}, std::nullopt});
  for (const auto* no : {"*.7.output.2", "devices.7.input.2", "devices.7.output", "devices.*.*",
                         "devices.7.output.2.period", "devices.x.output.*", "devices.00.output.1"})
    CHECK(parse_output_pattern(no).error() == errc::bad_value);
}

TEST_CASE("the role of a gateway among several is a word and since when", "[core][GW-14]") {
  CHECK(device_role_text(true, instant{12345ms}) == "leads 12.345000");
  CHECK(device_role_text(false, {}) == "stands_by 0.000000");
  CHECK(*parse_device_role("leads 12.345000"));
  CHECK(!*parse_device_role("stands_by 0.000000"));
  for (const auto* text : {"", "leads", "leads ", "leads x", "follows 1.000000", "stands by 1.0"})
    CHECK(!parse_device_role(text));
  CHECK(to_string(device_key{device_tuple::role, {}, 0}) == "devices.role");
  CHECK(parse_device_key("Devices.Gateways")->what == device_tuple::gateways);
}
