#include "io/files/stored_number.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace rubicon;
namespace fs = std::filesystem;

namespace {

io::stored_number stored_in(const std::string& path) {
  return std::get<io::stored_number>(io::stored_number::open(path));
}

} // namespace

TEST_CASE("a number is kept for who opens the file again", "[io]") {
  const test::scratch_folder in;
  auto first = stored_in(in.file("n"));
  CHECK(first.value() == 0);
  CHECK(first.store(7).empty());
  CHECK(first.store(4'294'967'295).empty());
  CHECK(stored_in(in.file("n")).value() == 4'294'967'295);
  CHECK_FALSE(fs::exists(in.file("n.new")));
}

TEST_CASE("a file that holds something else is told, and stays", "[io]") {
  const test::scratch_folder in;
  for (const std::string text : {"", "x", "-1", "4294967296", "7 8", "7\n\n8"}) {
    std::ofstream(in.file("n")) << text;
    const auto found = io::stored_number::open(in.file("n"));
    REQUIRE(std::holds_alternative<std::string>(found));
    CHECK(std::get<std::string>(found).starts_with(in.file("n") + " contains no number"));
    CHECK(fs::file_size(in.file("n")) == text.size());
  }
}

TEST_CASE("a number that cannot be kept is told", "[io]") {
  const test::scratch_folder in;
  auto x = stored_in(in.file("no/such/folder"));
  CHECK(x.store(1).find("cannot be written: No such file") != std::string::npos);
  CHECK(x.value() == 0);
}
