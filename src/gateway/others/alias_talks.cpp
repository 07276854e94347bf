#include "gateway/others/alias_talks.hpp"

#include <algorithm>

#include "transport/segment.hpp"

namespace rubicon::gateway {

namespace {

using kind = transport::segment::kind;

bool is_answer(kind x) {
  return x == kind::acknowledgement || x == kind::busy || x == kind::refused;
}

} // namespace

void alias_talks::note(island_id alias, island_id island, mote_id mote, byte_view segment) {
  const auto said = transport::decode_segment(segment);
  if (!said || (said->what != kind::reliable && said->what != kind::hello))
    return; // no answer is expected
  if (talks_.size() == talks_max)
    talks_.pop_front();
  talks_.push_back({alias, {island, mote}, said->source, said->counter});
}

island_id alias_talks::source_of(island_id island, mote_id receiver, byte_view segment) const {
  if (talks_.empty())
    return island;
  const auto said = transport::decode_segment(segment);
  if (!said || !is_answer(said->what))
    return island;
  const auto found = std::find_if(talks_.rbegin(), talks_.rend(), [&](const talk& x) {
    return x.other == mote_address{island, said->source} && x.sender == receiver &&
           x.counter == said->counter;
  });
  return found == talks_.rend() ? island : found->alias;
}

} // namespace rubicon::gateway
