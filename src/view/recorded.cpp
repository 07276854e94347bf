#include "view/recorded.hpp"

#include <utility>

#include "core/bytes.hpp"
#include "view/ecology_json.hpp"
#include "view/sample_json.hpp"

namespace rubicon::view {

void fill(timeline& out, std::shared_ptr<const explain::traces> all) {
  for (const auto& each : all->samples)
    if (auto sample = decode_sample(each);
        sample && (out.newest() == nullptr || out.newest()->at < sample->at))
      out.add(std::move(*sample));
  for (const auto& each : all->tuples) {
    const auto owner = all->about.peers.find(each.owner.value);
    out.add(report::tuple_write{
        .at = each.set.value_or(each.begun(all->nodes)),
        .peer = {},
        .owner = owner == all->about.peers.end() ? to_string(each.owner) : owner->second,
        .key = each.key,
        .value = each.is_text ? to_string(byte_view(each.value)) : "0x" + to_hex(each.value),
        .deleted = each.is_deletion});
  }
  for (const auto& each : all->events)
    out.add(listed_event{each.time, each.from.substr(each.from.find('/') + 1), each.text});
  for (auto& each : planned_faults(all->ecology))
    if (each.at <= all->end)
      out.add(std::move(each));
  out.set(run_state{all->end, all->end, false, 0});
  out.set(std::make_shared<const message_list>(std::move(all)));
}

} // namespace rubicon::view
