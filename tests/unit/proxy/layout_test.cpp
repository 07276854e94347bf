#include <clocale>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/codec.hpp"
#include "core/text/decimal.hpp"
#include "proxy/classes/layout.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::proxy;

namespace {

field count_field(encoding layout, std::size_t offset = 0) {
  field x;
  x.name = "count";
  x.channel = 1;
  x.offset = offset;
  x.layout = layout;
  x.decimals = 0;
  return x;
}

proxy_class reads(std::vector<field> fields) {
  proxy_class x;
  x.fields = std::move(fields);
  return x;
}

std::string first_text(const field& x, const bytes& payload) {
  const auto readings = decode(reads({x}), x.channel, payload);
  return readings && !readings->empty() ? readings->front().text : "refused";
}

} // namespace

TEST_CASE("each encoding reads its octets, most significant first", "[proxy][PXY-04][GW-11]") {
  const bytes all{0xff, 0x80, 0x01, 0x02, 0x03, 0x04};
  struct row {
    encoding layout;
    std::size_t offset;
    std::string text;
  };
  for (const auto& [layout, offset, text] : std::vector<row>{{encoding::u8, 0, "255"},
                                                             {encoding::i8, 0, "-1"},
                                                             {encoding::i8, 1, "-128"},
                                                             {encoding::u8, 5, "4"},
                                                             {encoding::u16, 0, "65408"},
                                                             {encoding::i16, 0, "-128"},
                                                             {encoding::i16, 2, "258"},
                                                             {encoding::u16, 4, "772"},
                                                             {encoding::u32, 0, "4286578946"},
                                                             {encoding::i32, 0, "-8388350"},
                                                             {encoding::i32, 2, "16909060"},
                                                             {encoding::u32, 1, "2147549699"}}) {
    CAPTURE(static_cast<int>(layout), offset);
    CHECK(first_text(count_field(layout, offset), all) == text);
  }
}

TEST_CASE("a payload that a field does not fit into is refused as a whole", "[proxy][PXY-04]") {
  for (const auto layout :
       {encoding::u8, encoding::i8, encoding::u16, encoding::i16, encoding::u32, encoding::i32})
    for (std::size_t offset = 0; offset < 3; ++offset) {
      const auto needed = offset + octets_of(layout);
      const auto what = reads({count_field(encoding::u8), count_field(layout, offset)});
      for (std::size_t size = 0; size < needed + 2; ++size) {
        const auto readings = decode(what, 1, bytes(size));
        CAPTURE(offset, needed, size);
        REQUIRE(static_cast<bool>(readings) == (size >= needed));
        if (readings)
          CHECK(readings->size() == 2);
        else
          CHECK(readings.error() == errc::truncated);
      }
    }
  const auto far = count_field(encoding::u32, std::numeric_limits<std::size_t>::max() - 1);
  CHECK_FALSE(decode(reads({far}), 1, bytes(8)));
}

TEST_CASE("raw octets become a value with a name and a unit", "[proxy][PXY-04]") {
  field temperature = count_field(encoding::i16);
  temperature.name = "temperature";
  temperature.scale = 0.1;
  temperature.decimals = 1;
  temperature.unit = "C";
  field humidity = count_field(encoding::u8, 2);
  humidity.name = "humidity";
  humidity.unit = "%";
  field other = count_field(encoding::u32, 9);
  other.channel = 2;
  const auto what = reads({humidity, temperature, other});
  const auto readings = decode(what, 1, bytes{0x00, 0xdf, 45});
  REQUIRE(readings);
  CHECK(*readings == std::vector<reading>{{"humidity", "45", "%"}, {"temperature", "22.3", "C"}});
  CHECK(decode(what, 3, bytes{})->empty());
  CHECK(reads(what, 1));
  CHECK(reads(what, 2));
  CHECK_FALSE(reads(what, 3));
}

TEST_CASE("counts are scaled, shifted and rounded", "[proxy][PXY-04]") {
  field x = count_field(encoding::i16);
  x.scale = 0.01;
  x.add = -39.6; // an SHT11's temperature
  x.decimals = 2;
  CHECK(first_text(x, bytes{0x18, 0x2c}) == "22.28");
  x.decimals = 0;
  CHECK(first_text(x, bytes{0x18, 0x2c}) == "22");
  x = count_field(encoding::i16);
  x.scale = -0.5;
  x.decimals = 1;
  CHECK(first_text(x, bytes{0x00, 0x03}) == "-1.5");
}

TEST_CASE("a number is written with its digits and nothing else", "[proxy][PXY-04]") {
  struct row {
    double value;
    int decimals;
    std::string text;
  };
  for (const auto& [value, decimals, text] :
       std::vector<row>{{0, 0, "0"},
                        {0, 3, "0.000"},
                        {-0.0, 1, "0.0"},
                        {-0.04, 1, "0.0"},
                        {-0.06, 1, "-0.1"},
                        {0.5, 0, "0"}, // a tie goes to the even digit
                        {1.5, 0, "2"},
                        {0.125, 2, "0.12"},
                        {0.375, 2, "0.38"},
                        {999.96, 1, "1000.0"},
                        {1e21, 0, "1000000000000000000000"},
                        {4294967295.0, 6, "4294967295.000000"},
                        {0.1, 6, "0.100000"},
                        {1e-7, 6, "0.000000"}})
    CHECK(decimal_text(value, decimals) == text);
  CHECK(decimal_text(std::numeric_limits<double>::max(), 6).size() == 309 + 7);
  CHECK(decimal_text(-std::numeric_limits<double>::max(), 6).size() == 309 + 8);
}

TEST_CASE("every count of tenths is written as people expect", "[proxy][PXY-04]") {
  field x = count_field(encoding::i16);
  x.scale = 0.1;
  x.decimals = 1;
  for (int count = -32768; count <= 32767; ++count) {
    const auto octets = byte_writer().big(static_cast<std::int16_t>(count)).finish();
    const auto size = std::abs(count);
    std::string expected = std::to_string(size / 10) + '.' + std::to_string(size % 10);
    if (count < 0)
      expected.insert(0, 1, '-');
    if (first_text(x, octets) != expected)
      FAIL(expected);
  }
}

TEST_CASE("a count may stand for a word", "[proxy][PXY-04]") {
  field x = count_field(encoding::i8);
  x.scale = 10;
  x.words = {{0, "off"}, {1, "on"}, {-1, "broken"}};
  CHECK(first_text(x, bytes{0}) == "off");
  CHECK(first_text(x, bytes{1}) == "on");
  CHECK(first_text(x, bytes{0xff}) == "broken");
  CHECK(first_text(x, bytes{2}) == "2");
  CHECK(first_text(x, bytes{0xfe}) == "-2");
}

TEST_CASE("a word becomes octets and an unknown word none", "[proxy][PXY-12]") {
  const input relay{"switch", 2, {{"on", {1}}, {"off", {0}}, {"reset", {}}, {"half", {0x7f, 2}}}};
  CHECK(*encode(relay, "on") == bytes{1});
  CHECK(*encode(relay, "off") == bytes{0});
  CHECK(encode(relay, "reset")->empty());
  CHECK(*encode(relay, "half") == bytes{0x7f, 2});
  for (const auto* const word : {"", "On", "on ", " on", "o", "onn", "1"}) {
    const auto refused = encode(relay, word);
    REQUIRE_FALSE(refused);
    CHECK(refused.error() == errc::bad_value);
  }
}

TEST_CASE("a number becomes the octets of its count", "[proxy][PXY-12]") {
  using rubicon::proxy::input;
  using rubicon::proxy::number_form;
  struct row {
    number_form form;
    const char* word;
    const char* octets; ///< empty: refused
  };
  const auto r = GENERATE(values<row>({
      {{encoding::u8, 2.55, 0, 0, 100}, "0", "00"},
      {{encoding::u8, 2.55, 0, 0, 255}, "255", "64"},
      {{encoding::u8, 1, 0, 0, 255}, "12.5", "0d"},
      {{encoding::u8, 1, 0, 0, 255}, "256", ""},
      {{encoding::u8, 1, 0, 0, 255}, "-0.1", ""},
      {{encoding::u8, 1, 0, 0, 255}, "12 ", ""},
      {{encoding::u8, 1, 0, 0, 255}, "nan", ""},
      {{encoding::i8, 1, 0, -128, 127}, "-1", "ff"},
      {{encoding::i16, 0.1, -40, -40, 60}, "21.5", "0267"},
      {{encoding::i16, 0.1, 0, -3276.8, 3276.7}, "-0.2", "fffe"},
      {{encoding::u16, -1, 100, 0, 100}, "30", "0046"},
      {{encoding::u32, 1, 0, 0, 4294967295.0}, "4294967295", "ffffffff"},
      {{encoding::i32, 1, 0, -5, 5}, "-5", "fffffffb"},
      {{encoding::u8, 1, 0, 0, 255}, "off", "00ff"},
  }));
  CAPTURE(r.word, r.octets);
  input x{"level", 2, {{"off", {0x00, 0xff}}}};
  x.numbers = r.form;
  const auto octets = rubicon::proxy::encode(x, r.word);
  if (std::string(r.octets).empty())
    CHECK(octets.error() == errc::bad_value);
  else
    CHECK(to_hex(*octets) == r.octets);
}
