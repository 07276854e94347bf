#include "control/frame.hpp"

#include "control/octets.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using control::frame;
using control::frame_reader;
using state = control::frame_reader::state;

namespace {

bytes octets_of(const frame& x) {
  auto out = control::encode_header(x);
  out.insert(out.end(), x.content.begin(), x.content.end());
  return out;
}

template <class T>
std::uint8_t kind_of() {
  return static_cast<std::uint8_t>(deploy::question(T{}).index());
}

/// Of a frame that only announces.
bytes header(std::uint8_t kind, std::uint32_t size) {
  auto out = control::encode_header({kind, 1, {}});
  for (std::size_t i = 0; i < 4; ++i)
    out[8 + i] = static_cast<std::uint8_t>(size >> (24 - 8 * i));
  return out;
}

state after(const bytes& octets) {
  frame_reader reader(control::question_limits());
  static_cast<void>(reader.feed(octets));
  return reader.now();
}

} // namespace

TEST_CASE("a frame is put together from any pieces, and takes no more than is its own",
          "[control]") {
  const frame asked{kind_of<deploy::greeting>(), 7, bytes(300, 'x')};
  auto octets = octets_of(asked);
  octets.push_back('R');
  for (const std::size_t piece : {1U, 5U, 12U, 13U, 400U}) {
    frame_reader reader(control::question_limits());
    byte_view rest(octets);
    while (reader.now() != state::complete)
      rest = rest.subspan(reader.feed(rest.first(std::min(piece, rest.size()))));
    CHECK(rest.size() == 1);
    CHECK(reader.feed(rest) == 0);
    const auto found = reader.take();
    CHECK(found.kind == asked.kind);
    CHECK(found.number == 7);
    CHECK(found.content == asked.content);
    CHECK(reader.feed(rest) == 1);
  }
}

TEST_CASE("a frame without content is complete with its header", "[control]") {
  CHECK(after(octets_of({kind_of<deploy::ask_facts>(), 1, {}})) == state::complete);
}

TEST_CASE("a frame that announces more than its kind may have is refused", "[control]") {
  const auto limits = control::question_limits();
  for (std::uint8_t kind = 0; kind < limits.size(); ++kind) {
    INFO(int(kind));
    const auto most = static_cast<std::uint32_t>(limits[kind]);
    CHECK(after(header(kind, most)) == state::content);
    CHECK(after(header(kind, most + 1)) == state::refused);
    CHECK(after(header(kind, 0xffffffff)) == state::refused);
    const bool has_files =
        kind == kind_of<deploy::offer>() || kind == kind_of<deploy::offer_seeds>();
    CHECK((most > control::small_octets_max) == has_files);
  }
}

TEST_CASE("what is no frame, or of another layout or kind, is refused in words", "[control]") {
  auto other = header(0, 0);
  other[2] = 9;
  frame_reader reader(control::question_limits());
  static_cast<void>(reader.feed(other));
  REQUIRE(reader.now() == state::refused);
  CHECK(reader.problem().find("version 9") != std::string::npos);
  CHECK(reader.feed(other) == 0);
  CHECK(after(bytes{0x16, 3, 1, 2, 0, 1, 0, 1, 0xfc, 3, 3, 0}) == state::refused); // a ClientHello
  CHECK(after(header(200, 0)) == state::refused);
  CHECK(after(header(static_cast<std::uint8_t>(control::question_limits().size()), 0)) ==
        state::refused);
}
