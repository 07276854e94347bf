#include "proxy/manager.hpp"

#include <algorithm>

#include "core/tuples/device_keys.hpp"

namespace rubicon::proxy {

namespace {

constexpr std::string_view not_listed = "not_listed";
constexpr std::string_view gateway_gone = "gateway_gone";

} // namespace

manager::outputs manager::on_gateway_tuple(island_id island, std::string_view key, byte_view value,
                                           instant now) {
  const auto parsed = parse_device_key(key);
  if (parsed && parsed->what == device_tuple::list)
    return on_devices(island, tuple_text(value), now);
  if (parsed && parsed->what == device_tuple::type)
    return on_type(island, parsed->mote, value, now);
  if (parsed && parsed->what == device_tuple::status)
    return on_status(island, parsed->mote, tuple_text(value), now);
  ++counters_.foreign_tuples;
  return {};
}

manager::outputs manager::on_devices(island_id island, std::string_view text, instant) {
  outputs out;
  const auto listed = parse_device_list(text);
  if (!listed) {
    ++counters_.bad_lists;
    return out;
  }
  const auto from = motes_.lower_bound({island, mote_id{0}});
  for (auto x = from; x != motes_.end() && x->first.island == island; ++x)
    if (!std::binary_search(listed->begin(), listed->end(), x->first.mote))
      unlist(x->first, x->second, std::string(not_listed), out);
  for (const auto mote : *listed) {
    const mote_address address{island, mote};
    if (auto* const x = know(address)) {
      x->listed = true;
      update(address, *x, out);
    }
  }
  return out;
}

manager::outputs manager::on_type(island_id island, mote_id mote, byte_view octets, instant) {
  outputs out;
  const auto type = parse_device_type(octets);
  if (!type || mote.value > mote_id_max) {
    ++counters_.bad_types;
    return out;
  }
  const mote_address address{island, mote};
  if (auto* const x = know(address)) {
    x->type = *type;
    update(address, *x, out);
  }
  return out;
}

manager::outputs manager::on_status(island_id island, mote_id mote, std::string_view text,
                                    instant) {
  outputs out;
  auto status = parse_device_status(text);
  if (!status) {
    ++counters_.bad_statuses;
    return out;
  }
  const mote_address address{island, mote};
  auto* const x = know(address);
  if (x == nullptr)
    return out;
  x->stale = status->presence == device_presence::stale;
  x->left_cause = std::move(status->cause);
  if (!x->listed && x->cause == not_listed && !x->left_cause.empty())
    x->cause = x->left_cause;
  report_presence(address, *x, out);
  return out;
}

manager::outputs manager::on_gateway_gone(island_id island, instant) {
  outputs out;
  const auto from = motes_.lower_bound({island, mote_id{0}});
  for (auto x = from; x != motes_.end() && x->first.island == island; ++x)
    unlist(x->first, x->second, std::string(gateway_gone), out);
  return out;
}

manager::outputs manager::on_classes(class_table classes, instant) {
  outputs out;
  classes_ = std::move(classes);
  for (auto& [address, x] : motes_)
    update(address, x, out);
  return out;
}

manager::outputs manager::on_proxy_gone(const mote_address& mote, instant) {
  outputs out;
  const auto found = motes_.find(mote);
  if (found == motes_.end() || !found->second.class_name)
    return out;
  found->second.class_name.reset();
  update(mote, found->second, out);
  return out;
}

std::size_t manager::running() const {
  return static_cast<std::size_t>(std::count_if(
      motes_.begin(), motes_.end(), [](const auto& x) { return x.second.class_name.has_value(); }));
}

std::optional<std::string> manager::running_class(const mote_address& mote) const {
  const auto found = motes_.find(mote);
  return found == motes_.end() ? std::nullopt : found->second.class_name;
}

/// @returns the mote's entry, made if there is room for it, else nullptr
manager::known_mote* manager::know(const mote_address& mote) {
  const auto found = motes_.find(mote);
  if (found != motes_.end())
    return &found->second;
  if (motes_.size() >= motes_max_) {
    ++counters_.motes_refused;
    return nullptr;
  }
  return &motes_[mote];
}

void manager::unlist(const mote_address& mote, known_mote& x, std::string cause, outputs& out) {
  if (x.listed)
    x.cause = cause == not_listed && !x.left_cause.empty() ? x.left_cause : std::move(cause);
  x.listed = false;
  report_presence(mote, x, out);
}

void manager::update(const mote_address& mote, known_mote& x, outputs& out) {
  if (!x.listed)
    return;
  follow_type(mote, x, out);
  report_presence(mote, x, out);
}

/// Reports the mote's presence to its proxy, if it has changed since the last report.
void manager::report_presence(const mote_address& mote, known_mote& x, outputs& out) {
  if (!x.class_name)
    return;
  const auto presence = !x.listed ? device_presence::left
                        : x.stale ? device_presence::stale
                                  : device_presence::listed;
  const auto& cause = x.listed ? std::string() : x.cause;
  if (x.reported_presence == presence && x.reported_cause == cause)
    return;
  x.reported_presence = presence;
  x.reported_cause = cause;
  out.emplace_back(set_presence{mote, presence, cause});
}

/// Gives a listed mote the proxy that its type asks for.
void manager::follow_type(const mote_address& mote, known_mote& x, outputs& out) {
  if (!x.type || (x.class_name && *x.type == x.class_type))
    return;
  const auto* const wanted = classes_.find(signature_of(mote, *x.type));
  x.class_type = *x.type;
  if (x.class_name && wanted != nullptr && wanted->name == *x.class_name)
    return;
  if (x.class_name) {
    x.class_name.reset();
    ++counters_.stopped;
    out.emplace_back(stop_proxy{mote});
  }
  if (wanted != nullptr) {
    x.class_name = wanted->name;
    x.reported_presence = device_presence::listed; // it assumes so
    x.reported_cause.clear();
    ++counters_.started;
    out.emplace_back(start_proxy{mote, wanted->name});
  } else if (x.reported != x.type) {
    x.reported = x.type;
    out.emplace_back(unknown_type{mote, *x.type});
  }
}

} // namespace rubicon::proxy
