// Octets of a connection: frames come out the same whatever the pieces, and none is longer than its
// kind may be.
#include <vector>

#include "control/frame.hpp"

#include "fuzz/require.hpp"

using namespace rubicon;

namespace {

struct outcome {
  std::vector<control::frame> frames;
  bool is_refused = false;
};

outcome read(byte_view octets, std::size_t piece) {
  outcome out;
  control::frame_reader reader(control::question_limits());
  while (!octets.empty()) {
    auto some = octets.first(std::min(piece, octets.size()));
    octets = octets.subspan(some.size());
    while (!some.empty()) {
      some = some.subspan(reader.feed(some));
      if (reader.now() == control::frame_reader::state::refused) {
        require(!reader.problem().empty());
        out.is_refused = true;
        return out;
      }
      if (reader.now() == control::frame_reader::state::complete)
        out.frames.push_back(reader.take());
    }
  }
  return out;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const byte_view octets(data, size);
  const auto whole = read(octets, size + 1);
  const auto cut = read(octets, 1);
  require(whole.is_refused == cut.is_refused);
  require(whole.frames.size() == cut.frames.size());
  for (std::size_t i = 0; i < whole.frames.size(); ++i) {
    const auto& x = whole.frames[i];
    require(x.kind == cut.frames[i].kind && x.number == cut.frames[i].number);
    require(x.content == cut.frames[i].content);
    require(x.content.size() <= control::question_limits()[x.kind]);
  }
  return 0;
}
