#include <algorithm>
#include <utility>

#include "explain/media.hpp"

namespace rubicon::explain {

/// Hands each record to those whom it concerns.
class following::follower {
public:
  follower(const header& about, bool keeps_view) : all_(about), keeps_view_(keeps_view) {}

  void take(const record& r);
  [[nodiscard]] traces& found() { return all_.all; }

private:
  void on_event(const record& r);

  growth all_;
  message_follower messages_{all_};
  tuple_follower tuples_{all_};
  air_follower air_{all_, messages_};
  line_follower lines_{all_, messages_};
  backbone_follower backbones_{all_, air_};
  link_follower links_{all_, messages_, tuples_};
  bool keeps_view_;
};

void following::follower::take(const record& r) {
  all_.note(r);
  const bool is_hop = r.what == kind::serial_octets || r.what == kind::link_octets ||
                      r.what == kind::backbone_received;
  if (r.unheard && !is_hop) // nobody makes anything of it
    return;
  switch (r.what) {
  case kind::begun:
    return messages_.on_begun(r);
  case kind::radio_send:
    return air_.on_send(r);
  case kind::radio_done:
    return air_.on_done(r);
  case kind::frame:
    return air_.on_frame(r);
  case kind::frame_received:
    return air_.on_received(r);
  case kind::serial_write:
    return lines_.on_write(r);
  case kind::serial_octets:
    return lines_.on_octets(r);
  case kind::plug_serial:
    return r.to.starts_with("backbone/") ? backbones_.on_plug(r) : lines_.on_plug(r);
  case kind::backbone_write:
    return backbones_.on_write(r);
  case kind::backbone_received:
    return backbones_.on_received(r);
  case kind::link_opened:
    return links_.on_opened(r);
  case kind::link_octets:
  case kind::link_lost:
    return links_.on_package(r);
  case kind::set_tuple:
    return tuples_.on_set(r, false);
  case kind::delete_tuple:
    return tuples_.on_set(r, true);
  case kind::set_remote_tuple:
    if (const auto asked = tuples_.on_set_remote(r))
      links_.on_asked(r, *asked);
    return;
  case kind::tuple_event:
    return tuples_.on_event(r);
  case kind::watch_tuples:
    all_.all.watchers.push_back({r.from, r.peer, r.text, r.time});
    return;
  case kind::send_peis_message:
    return links_.on_send(r);
  case kind::peis_outcome:
    return links_.on_outcome(r);
  case kind::send_message:
    return messages_.on_send(r);
  case kind::message_received:
    return messages_.on_message(r);
  case kind::send_ended:
    return messages_.on_send_ended(r);
  case kind::message_ended:
    return messages_.on_ended(r);
  case kind::actuator_changed:
    return; // its event says more
  case kind::event:
    return on_event(r);
  case kind::ecology:
    if (keeps_view_)
      all_.all.ecology = r.text;
    return;
  case kind::sample:
    if (keeps_view_)
      all_.all.samples.push_back(r.text);
    return;
  }
}

void following::follower::on_event(const record& r) {
  all_.all.events.push_back(r);
  const auto parent = all_.step_of(r.cause);
  const bool is_of_mote = r.from.starts_with("mote/") || r.from.starts_with("mote_app/");
  if (parent == no_node || !is_of_mote) // actions of components show in their tuples
    return;
  node x;
  x.what = step::acts;
  x.about = all_.at(parent).about;
  x.from = r.from;
  x.begin = r.time;
  x.arrived = r.time;
  x.text = r.text;
  all_.add(std::move(x), parent);
  // What is sent at that moment is sent because of it.
  auto& siblings = all_.at(parent).children;
  const auto sent = std::ranges::find_if(siblings, [&](node_index each) {
    return all_.at(each).what == step::sends && all_.at(each).begin == r.time;
  });
  if (sent != siblings.end())
    std::rotate(sent, std::prev(siblings.end()), siblings.end());
}

following::following(const header& about, bool keeps_view)
    : all_(std::make_unique<follower>(about, keeps_view)) {}
following::~following() = default;
following::following(following&&) noexcept = default;
following& following::operator=(following&&) noexcept = default;

void following::take(const record& x) {
  all_->take(x);
}

const traces& following::so_far() const {
  return all_->found();
}

traces following::finish(bool cut_off) {
  auto& found = all_->found();
  found.cut_off = cut_off;
  return std::move(found);
}

traces follow(const recording& x) {
  following all(x.about);
  for (const auto& r : x.records)
    all.take(r);
  return all.finish(x.cut_off);
}

} // namespace rubicon::explain
