#include "firmware/library.hpp"

#include <cstdlib>
#include <string>

#include "config/load.hpp"
#include "core/numbers/random.hpp"
#include "firmware/native_code.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::firmware;

namespace {

bytes file(const std::string& name) {
  const auto found =
      config::read_file(std::string(RUBICON_FIRMWARES "/").append(name), library_octets_max);
  REQUIRE(found.text.has_value());
  return to_bytes(*found.text);
}

std::string wrong_with(byte_view octets) {
  const auto found = inspect(octets);
  const auto* wrong = std::get_if<std::string>(&found);
  return wrong == nullptr ? "" : *wrong;
}

} // namespace

TEST_CASE("a firmware is known by the object that it exports", "[firmware]") {
  CHECK(std::get<library_facts>(inspect(file("flood.so"))) == library_facts{1, 0});
  CHECK(std::get<library_facts>(inspect(file("pair.so"))) == library_facts{1, 0});
  CHECK(wrong_with(file("empty.so")) == "exports no object `rubicon_mote_firmware`");
}

TEST_CASE("a firmware for another version is refused", "[firmware]") {
  CHECK(refusal({1, 0}).empty());
  CHECK(refusal({7, 0}) == "is for version 7 of rubicon_mote.h; this host has 1");
  CHECK(refusal(std::get<library_facts>(inspect(file("version7.so")))) ==
        "is for version 7 of rubicon_mote.h; this host has 1");
}

TEST_CASE("what is no shared library of this machine is refused", "[firmware]") {
  CHECK(wrong_with({}) == "is no shared library (ELF, 64 bits)");
  CHECK(wrong_with(to_bytes(std::string_view("int main(void) { return 0; }"))) ==
        "is no shared library (ELF, 64 bits)");
  auto octets = file("flood.so");
  octets.at(16) = 2; // an executable
  CHECK(wrong_with(octets) == "is no shared library: link it with -shared");
  octets = file("flood.so");
  octets.at(18) = 8; // MIPS
  CHECK(wrong_with(octets) == "is a shared library for another processor");
}

TEST_CASE("a library that is cut or damaged is judged without harm", "[firmware]") {
  const auto whole = file("flood.so");
  for (std::size_t size = 0; size < whole.size(); size += 61)
    CHECK(!wrong_with(byte_view(whole).first(size)).empty());
  random_stream rng(4);
  for (int i = 0; i < 2000; ++i) {
    auto damaged = whole;
    for (int n = 0; n < 4; ++n) // most of it in the headers, at the ends of the file
      damaged.at(rng.chance(0.5) ? rng.below(64 * 12) : damaged.size() - 1 - rng.below(64 * 30)) =
          static_cast<std::uint8_t>(rng.next());
    static_cast<void>(inspect(damaged));
  }
}

TEST_CASE("a firmware without a function that it must have does not start", "[firmware]") {
  rubicon_mote_firmware x{};
  x.version = RUBICON_MOTE_VERSION;
  CHECK_THROWS_WITH(native_code(x), "the firmware lacks one of init, run, received and sent");
  x.version = 2;
  CHECK_THROWS_WITH(native_code(x),
                    "the firmware is for version 2 of rubicon_mote.h; this host has 1");
}
