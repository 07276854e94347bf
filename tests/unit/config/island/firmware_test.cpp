// The firmware of motes.
#include <map>
#include <string>

#include "support/catch.hpp"
#include "support/elf_file.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

const std::map<std::string, std::string> libraries{
    {"lab/blink.so", to_string(elf_file(1))},
    {"lab/both.so", to_string(elf_file(1, 1))},
    {"lab/later.so", to_string(elf_file(2))},
    {"lab/other.so", to_string(elf_file(1, 0, "something"))},
    {"lab/text.so", "no library"},
};

/// From line 10 the mote's keys.
loaded load_mote(const std::string& mote, const std::string& island = "stack = \"mac\"",
                 const std::string& ecology = "mode = \"virtual\"") {
  const auto toml = "[ecology]\nname = \"t\"\n" + ecology + "\n[[island]]\nname = \"k\"\nid = 1\n" +
                    island + "\n[[island.mote]]\nid = 2\nposition_m = [1, 2]\n" + mote + "\n";
  return load_text(toml, "lab/x.toml", {},
                   [](const std::string& path, std::size_t) { return text_in(libraries, path); });
}

} // namespace

TEST_CASE("the firmware of a mote is a file beside the TOML file", "[config][firmware]") {
  const auto x = load_mote("firmware = \"blink.so\"");
  CAPTURE(problems_of(x));
  REQUIRE(x.ecology);
  const auto& app =
      std::get<firmware::program_config>(x.ecology->islands.at(0).motes.at(0).apps.at(0));
  CHECK(app.code->name == "blink.so");
  CHECK(app.code->octets == elf_file(1));
  CHECK(load_mote("firmware = \"blink.so\"", "sink = { role = \"base_station\" }").ecology);
}

TEST_CASE("motes of a group, and of a type, share the octets of their firmware",
          "[config][firmware]") {
  const auto toml = std::string("[ecology]\nname = \"t\"\n[mote_type.c]\ntype = 7\n"
                                "firmware = \"blink.so\"\n[[island]]\nname = \"k\"\nid = 1\n"
                                "stack = \"mac\"\n[[island.group]]\ncount = 3\ntype = \"c\"\n"
                                "layout = \"line\"\nspacing = \"5m\"\n");
  const auto x = load_text(toml, "lab/x.toml", {}, [](const std::string& path, std::size_t) {
    return text_in(libraries, path);
  });
  CAPTURE(problems_of(x));
  REQUIRE(x.ecology);
  const auto code_of = [&](std::size_t mote) {
    return std::get<firmware::program_config>(x.ecology->islands.at(0).motes.at(mote).apps.at(0))
        .code;
  };
  CHECK(code_of(0) == code_of(2));
}

TEST_CASE("what cannot be the firmware of a mote has its place", "[config][firmware][ACT-13]") {
  const auto wrong = [](const std::string& file) {
    return problems_of(load_mote("firmware = \"" + file + "\""));
  };
  CHECK(wrong("none.so") ==
        "lab/x.toml:11:12: \"lab/none.so\" cannot be opened: No such file or directory");
  CHECK(wrong("text.so") ==
        "lab/x.toml:11:12: \"lab/text.so\" is no shared library (ELF, 64 bits)");
  CHECK(wrong("other.so") ==
        "lab/x.toml:11:12: \"lab/other.so\" exports no object `rubicon_mote_firmware`");
  CHECK(wrong("later.so") == "lab/x.toml:11:12: \"lab/later.so\" is for version 2 of "
                             "rubicon_mote.h; this host has 1");
}

TEST_CASE("firmware needs an island that motes do not join, and no other programs",
          "[config][firmware]") {
  CHECK(problems_of(load_mote("type = 1\nfirmware = \"blink.so\"", "")) ==
        "lab/x.toml:12:12: `firmware` needs an island with stack = \"mac\", or one whose sink has "
        "role = \"base_station\": its motes do not join");
  CHECK(problems_of(load_mote("firmware = \"blink.so\"\napps = [{ app = \"blink\" }]",
                              "sink = { role = \"base_station\" }")) ==
        "lab/x.toml:11:12: a mote with `firmware` has no other apps than sender, relay and "
        "receiver: it is its firmware that runs on it");
}

TEST_CASE("firmware runs in wall time only if it says that it can", "[config][firmware]") {
  CHECK(problems_of(load_mote("firmware = \"blink.so\"", "stack = \"mac\"", "mode = \"wall\"")) ==
        "lab/x.toml:11:12: the firmware runs in virtual time only: it does not have the flag "
        "RUBICON_MOTE_WALL_TIME");
  CHECK(load_mote("firmware = \"both.so\"", "stack = \"mac\"", "mode = \"wall\"").ecology);
}
