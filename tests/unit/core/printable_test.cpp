#include "core/text/printable.hpp"

#include <string>

#include "support/catch.hpp"

using namespace rubicon;

TEST_CASE("what disturbs a terminal or a log is shown, not done", "[core][NFR-01]") {
  CHECK(printable("22.3 °C") == "22.3 °C");
  CHECK(printable("a\n\033[31mb\x7f") == R"(a\n\x1b[31mb\x7f)");
  CHECK(printable(std::string_view("\0\t\r", 3)) == R"(\x00\t\r)");
  CHECK(printable("\xc2\x9b") == R"(\u009b)");           // C1 control CSI
  CHECK(printable("\xe2\x80\xae") == R"(\u202e)");       // turns the text round
  CHECK(printable("\xe2\x80\xa8") == R"(\u2028)");       // a line's end to some
  CHECK(printable("\xf3\xa0\x80\xa0") == R"(\U0e0020)"); // a tag that is not shown
  CHECK(printable("\xff"
                  "a\xc3") == R"(\xffa\xc3)");                   // never UTF-8; cut short
  CHECK(printable("\xc0\xaf") == R"(\xc0\xaf)");                 // overlong
  CHECK(printable("\xed\xa0\x80") == R"(\xed\xa0\x80)");         // surrogate
  CHECK(printable("\xf4\x90\x80\x80") == R"(\xf4\x90\x80\x80)"); // beyond U+10FFFF
  CHECK(printable("\xf0\x9f\xa4\x96") == "\xf0\x9f\xa4\x96");
}

TEST_CASE("what is printable stays as it is, and what is too long is cut", "[core]") {
  const auto once = printable("a\\b\033\xff");
  CHECK(printable(once) == once);
  CHECK(printable(std::string(100, 'x'), 10) == std::string(10, 'x') + "…");
  CHECK(printable(std::string(10, 'x'), 10) == std::string(10, 'x'));
}

TEST_CASE("JSON for a terminal means the same, and holds no controls", "[core]") {
  CHECK(printable_json("{\n  \"a\": \"22 °C\"\n}") == "{\n  \"a\": \"22 °C\"\n}");
  CHECK(printable_json("\"\x7f\xc2\x9b\xe2\x80\xae\"") == R"("\u007f\u009b\u202e")");
  CHECK(printable_json("\"\xf3\xa0\x80\xa0\"") == R"("\udb40\udc20")");
}
