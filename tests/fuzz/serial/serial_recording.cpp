// A line of a serial recording: no crash on any text, and what is read is written the same again.
#include <cstdlib>

#include "serial/recording.hpp"

using namespace rubicon;
using namespace rubicon::serial;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = to_string(byte_view(data, size));
  static_cast<void>(read_recording(text, "kitchen"));
  const auto x = read_recorded(text);
  const auto* frame = std::get_if<recorded_frame>(&x);
  if (frame == nullptr)
    return 0;
  const auto back = read_recorded(to_text(*frame));
  const auto* same = std::get_if<recorded_frame>(&back);
  if (same == nullptr || same->what != frame->what || same->island != frame->island)
    std::abort();
  return 0;
}
