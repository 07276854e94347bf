// What a page asks, and samples in a record: any text gets an answer that is JSON.
#include <cassert>
#include <cstdint>
#include <string>
#include <string_view>

#include "view/conversation.hpp"
#include "view/sample_json.hpp"

using namespace rubicon;

static std::shared_ptr<const view::introduction> about(std::string facts) {
  return std::make_shared<const view::introduction>(view::introduction_of(std::move(facts)));
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto sample = view::decode_sample(text))
    assert(view::decode_sample(view::encode(*sample)));
  auto all = std::make_shared<view::timeline>();
  report::run_sample sample;
  sample.motes.resize(1);
  all->add(sample);
  view::conversation with(
      all, about(R"({"islands":[{"id":0,"name":"a","motes":[[0,"b",0,0,""]]}]})"), nullptr);
  assert(with.on_text(text).starts_with('{'));
  view::conversation other(all, about(std::string(text)), nullptr); // a record's ecology
  static_cast<void>(other.news());
  static_cast<void>(other.on_text(R"({"ask":"moment","at_s":1})"));
  return 0;
}
