#include <array>
#include <string>

#include <unistd.h>

#include "io/files/unwaiting_output.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

struct pipe_ends {
  int reads = -1;
  int writes = -1;

  pipe_ends() {
    std::array<int, 2> ends{};
    REQUIRE(::pipe(ends.data()) == 0);
    reads = ends[0];
    writes = ends[1];
  }
  ~pipe_ends() {
    ::close(reads);
    ::close(writes);
  }

  std::string take(std::size_t octets) const {
    std::string text(octets, ' ');
    const auto got = ::read(reads, text.data(), text.size());
    text.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return text;
  }
};

} // namespace

TEST_CASE("what is read in time is all there, in its order", "[io]") {
  const pipe_ends ends;
  io::unwaiting_output out(ends.writes);
  out.write("one\n");
  out.write("two\n");
  CHECK(out.flush(0s));
  CHECK(out.missed() == 0);
  CHECK(ends.take(100) == "one\ntwo\n");
}

TEST_CASE("nobody waits for a reader that has stopped, and what he misses is counted", "[io]") {
  const pipe_ends ends;
  io::unwaiting_output out(ends.writes);
  const std::string line(999, 'x');
  constexpr std::size_t lines = 400; // more than pipe and buffer take
  for (std::size_t i = 0; i < lines; ++i)
    out.write(line + '\n');
  CHECK(out.missed() == 0); // he would not hear of it yet
  CHECK_FALSE(out.flush(1ms));
  std::string seen;
  while (!out.flush(0s))
    seen += ends.take(4096);
  const auto missed = out.missed();
  CHECK(missed > 0);
  CHECK(out.missed() == 0);
  out.write("again\n");
  for (auto more = ends.take(4096); !more.empty(); more = ends.take(4096)) {
    seen += more;
    if (seen.ends_with("again\n"))
      break;
  }
  CHECK(seen.size() == (lines - missed) * (line.size() + 1) + 6);
  CHECK(seen.find("xx\n") != std::string::npos);
}
