#include "proxy/object_manager.hpp"

#include "core/tuples/device_keys.hpp"
#include "core/tuples/interface_keys.hpp"

namespace rubicon::proxy {

object_manager::outputs object_manager::on_tuple(peer_id owner, std::string_view key,
                                                 byte_view value, bool deleted) {
  outputs out;
  const auto parsed = parse_interface_key(key);
  const bool is_list = parsed && parsed->what == interface_tuple::objects;
  if (!is_list && !(parsed && parsed->what == interface_tuple::channel)) {
    ++counters_.foreign_tuples;
    return out;
  }
  const interface_id from{owner, parsed->name};
  if (deleted) {
    interfaces_.erase(from);
    return out;
  }
  if (!interfaces_.contains(from) && interfaces_.size() >= objects_max_) {
    ++counters_.refused;
    return out;
  }
  auto& known = interfaces_[from];
  if (!is_list) {
    known.channel = tuple_text(value);
  } else if (auto list = parse_object_list(tuple_text(value))) {
    known.perceived = *std::move(list);
  } else {
    ++counters_.bad_lists;
    return out;
  }
  review(known, out);
  return out;
}

object_manager::outputs object_manager::on_classes(class_table classes) {
  outputs out;
  classes_ = std::move(classes);
  unknown_.clear();
  for (const auto& [id, x] : interfaces_)
    review(x, out);
  return out;
}

object_manager::outputs object_manager::on_proxy_gone(const signature& percept) {
  outputs out;
  running_.erase({percept.channel, percept.hardware_id});
  for (const auto& [id, x] : interfaces_)
    review(x, out);
  return out;
}

void object_manager::review(const interface& x, outputs& out) {
  if (x.channel.empty() || x.channel == wsn_channel)
    return;
  for (const auto& id : x.perceived) {
    const object what{x.channel, id};
    if (running_.contains(what) || unknown_.contains(what))
      continue;
    if (running_.size() + unknown_.size() >= objects_max_) {
      ++counters_.refused;
      continue;
    }
    const signature percept{x.channel, id, 0};
    if (const auto* found = classes_.find(percept)) {
      running_.insert(what);
      ++counters_.started;
      out.emplace_back(start_object_proxy{percept, found->name});
    } else {
      unknown_.insert(what);
      out.emplace_back(unknown_object{percept});
    }
  }
}

} // namespace rubicon::proxy
