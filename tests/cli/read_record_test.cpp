// Records that are read while they are written.
#include <fstream>
#include <string>

#include "cli/record/read_record.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace rubicon;
using cli::record_reader;

namespace {

/// A message that a mote of no island sends.
std::string line(std::uint64_t number, instant at) {
  explain::record x;
  x.number = number;
  x.time = at;
  x.what = explain::kind::send_message;
  x.from = "mote_app/kitchen/near/messenger-1";
  x.to = "mote/kitchen/near";
  x.id = number;
  x.mote = {own_island, no_mote};
  return encode(x);
}

struct growing_file {
  test::scratch_folder folder;
  std::string path = folder.file("run.rec");
  std::ofstream file{path, std::ios::binary};

  growing_file() {
    explain::header about;
    about.islands = {{1, "kitchen", 1, "kitchen-gateway", {{7, "near"}}, {}, {}}};
    add(encode(about));
  }
  void add(const std::string& text) { (file << text).flush(); }
};

void read_all(record_reader& x) {
  while (x.read_part()) {
  }
}

} // namespace

TEST_CASE("a record is read on from where it has ended, also within a line", "[cli][explain]") {
  growing_file to;
  record_reader reader(to.path);
  CHECK_FALSE(reader.has_begun());
  read_all(reader);
  REQUIRE(reader.has_begun());
  CHECK(reader.so_far().messages.empty());
  const auto first = line(1, instant(1s));
  const auto second = line(2, instant(2s));
  to.add(first + second.substr(0, 9));
  read_all(reader);
  CHECK(reader.so_far().messages.size() == 1);
  CHECK(reader.so_far().end == instant(1s));
  to.add(second.substr(9, 3));
  read_all(reader);
  CHECK(reader.so_far().messages.size() == 1);
  to.add(second.substr(12) + line(3, instant(3s)).substr(0, 20));
  read_all(reader);
  CHECK(reader.so_far().messages.size() == 2);
  CHECK(reader.so_far().end == instant(2s));
  reader.finish();
  CHECK(reader.problem().empty());
  CHECK(reader.result().cut_off);
}

TEST_CASE("lines longer than what is read at once are read", "[cli][explain]") {
  growing_file to;
  explain::record view;
  view.what = explain::kind::ecology;
  view.text = std::string(3 * record_reader::part_octets, 'x');
  to.add(encode(view) + line(1, instant(1s)));
  for (const bool keeps_view : {true, false}) {
    record_reader reader(to.path, keeps_view);
    read_all(reader);
    CHECK(reader.so_far().messages.size() == 1);
    CHECK(reader.so_far().ecology.size() == (keeps_view ? view.text.size() : 0));
  }
}

TEST_CASE("what is no record is told with its line, and nothing more is read", "[cli][explain]") {
  growing_file to;
  to.add(line(1, instant(1s)) + "no JSON\n" + line(2, instant(2s)));
  record_reader reader(to.path);
  read_all(reader);
  CHECK(reader.problem() == to.path + ":3: this is not a JSON object");
  CHECK(reader.so_far().messages.size() == 1);
  to.add(line(3, instant(3s)));
  CHECK_FALSE(reader.read_part());
  reader.finish();
  CHECK(reader.problem() == to.path + ":3: this is not a JSON object");
  CHECK(record_reader(to.folder.file("none"))
            .problem()
            .find("none: cannot be read: No such file or directory; `rubicon run ") !=
        std::string::npos);
  std::ofstream(to.folder.file("empty"));
  record_reader empty(to.folder.file("empty"));
  read_all(empty);
  CHECK(empty.problem().empty()); // it may still begin
  empty.finish();
  CHECK(empty.problem().find("it is empty") != std::string::npos);
}
