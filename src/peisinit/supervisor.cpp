#include "peisinit/supervisor.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubicon::peisinit {

namespace {

/// Equal up to letter case of the 26 ASCII letters; `word` is in lower case.
bool is_word(std::string_view x, std::string_view word) {
  return std::ranges::equal(x, word, [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

/// Cut, and with control characters replaced: for people.
std::string shown(std::string_view x) {
  constexpr std::size_t octets_max = 40;
  std::string text(x.substr(0, octets_max));
  std::ranges::replace_if(text, is_control, '?');
  return text;
}

} // namespace

std::string_view to_string(phase x) {
  switch (x) {
  case phase::off:
    return "off";
  case phase::starting:
    return "starting";
  case phase::on:
    return "on";
  case phase::stopping:
    return "stopping";
  case phase::waiting:
    return "waiting";
  }
  assert(false);
  return {};
}

supervisor::supervisor(std::vector<component> components)
    : components_(std::move(components)), states_(components_.size()) {
  for (std::size_t i = 0; i < states_.size(); ++i)
    states_[i].arguments = components_[i].arguments;
}

void supervisor::set(std::size_t component, std::string_view field, std::string text) {
  out_.emplace_back(publish{"components." + components_[component].name + '.' + std::string(field),
                            std::move(text)});
}

void supervisor::become(std::size_t component, phase next) {
  states_[component].at = next;
  set(component, "currState", std::string(to_string(next)));
}

void supervisor::refuse(std::size_t component, std::string why) {
  ++counters_.refused;
  out_.emplace_back(notice{components_[component].name + " refuses " + std::move(why)});
}

outputs supervisor::begin(instant /*now*/) {
  std::string names;
  for (const auto& x : components_)
    names += (names.empty() ? "" : " ") + x.name;
  out_.emplace_back(publish{"components", '(' + names + ')'});
  for (std::size_t i = 0; i < components_.size(); ++i) {
    const auto& x = components_[i];
    set(i, "reqState", x.on ? "on" : "off");
    set(i, "id", to_string(x.id));
    set(i, "pid", "0");
    set(i, "exec", x.peer.empty() ? x.command : "peer " + x.peer);
    set(i, "semantics", x.semantics);
    set(i, "proxy", x.proxy);
    set(i, "extra-arguments", x.arguments);
    for (const auto* field : {"stdin", "stdout", "stderr"})
      set(i, field, "");
    become(i, phase::off);
  }
  for (std::size_t i = 0; i < components_.size(); ++i) {
    states_[i].wanted = components_[i].on;
    if (components_[i].on)
      begin_start(i);
  }
  return finish();
}

void supervisor::begin_start(std::size_t component) {
  auto& x = states_[component];
  ++x.life;
  ++counters_.starts;
  become(component, phase::starting);
  out_.emplace_back(start{component, x.life, x.arguments});
}

void supervisor::begin_stop(std::size_t component, stop_step step, instant now) {
  out_.emplace_back(notice{components_[component].name + " is to end"});
  become(component, phase::stopping);
  take_step(component, step, now);
}

void supervisor::take_step(std::size_t component, stop_step step, instant now) {
  auto& x = states_[component];
  if (step == stop_step::kill && x.step != stop_step::kill) {
    ++counters_.kills;
    out_.emplace_back(notice{components_[component].name + " is killed"});
  }
  x.step = step;
  x.due = now + stop_step_time;
  out_.emplace_back(stop{component, step});
}

outputs supervisor::on_request(std::size_t component, std::string_view word, instant now) {
  auto& x = states_[component];
  const bool abort = is_word(word, "abort");
  const bool on = is_word(word, "on") || is_word(word, "start");
  if (!on && !abort && !is_word(word, "off")) {
    refuse(component, "the state `" + shown(word) + '`');
    return finish();
  }
  if (on && shutting_down_) {
    refuse(component, "to start: all are to end");
    return finish();
  }
  x.wanted = on;
  if (on) {
    if (x.at == phase::off)
      begin_start(component);
    return finish();
  }
  if (x.at == phase::waiting) {
    become(component, phase::off);
    out_.emplace_back(notice{components_[component].name + " off"});
  } else if (x.at == phase::starting || x.at == phase::on) {
    x.step = stop_step::do_quit;
    begin_stop(component, abort ? stop_step::kill : stop_step::do_quit, now);
  } else if (x.at == phase::stopping && abort && x.step != stop_step::kill) {
    take_step(component, stop_step::kill, now);
  }
  return finish();
}

outputs supervisor::on_input(std::size_t component, std::string_view text) {
  if (text.empty())
    return finish();
  const auto& x = states_[component];
  if (!components_[component].peer.empty() || (x.at != phase::on && x.at != phase::stopping)) {
    refuse(component, "input");
    return finish();
  }
  feed line{component, std::string(text)};
  if (line.text.back() != '\n')
    line.text += '\n';
  out_.emplace_back(std::move(line));
  return finish();
}

outputs supervisor::on_arguments(std::size_t component, std::string_view text) {
  if (text.size() > arguments_octets_max || std::ranges::any_of(text, is_control))
    refuse(component, "arguments");
  else
    states_[component].arguments = std::string(text);
  return finish();
}

outputs supervisor::on_started(std::size_t component, std::uint64_t life, std::int64_t process) {
  auto& x = states_[component];
  if (life != x.life || (x.at != phase::starting && x.at != phase::stopping))
    return finish();
  set(component, "pid", std::to_string(process));
  if (x.at == phase::stopping)
    return finish();
  become(component, phase::on);
  out_.emplace_back(notice{components_[component].name + " on"});
  return finish();
}

outputs supervisor::on_ended(std::size_t component, std::uint64_t life, std::string_view how,
                             instant now) {
  auto& x = states_[component];
  if (life != x.life || x.at == phase::off || x.at == phase::waiting)
    return finish();
  const auto& what = components_[component];
  publish_tails(component, now);
  set(component, "pid", "0");
  if (x.at != phase::stopping) {
    ++counters_.ends;
    x.due = now + what.delay;
    become(component, phase::waiting);
    out_.emplace_back(notice{what.name + " has ended" +
                             (how.empty() ? std::string() : ", " + std::string(how)) +
                             ", again in " + to_text(what.delay)});
    return finish();
  }
  become(component, phase::off);
  out_.emplace_back(notice{what.name + " off"});
  if (x.wanted)
    begin_start(component);
  check_all_off();
  return finish();
}

outputs supervisor::on_output(std::size_t component, channel from, byte_view octets, instant now) {
  auto& x = states_[component];
  auto& to = x.tails[static_cast<std::size_t>(from)];
  const auto taken = octets.size() > tail_octets_max ? octets.last(tail_octets_max) : octets;
  to.text.append(taken.begin(), taken.end());
  if (to.text.size() > tail_octets_max)
    to.text.erase(0, to.text.size() - tail_octets_max);
  std::ranges::replace(to.text, '\0', '?'); // with a NUL a text ends
  to.changed = true;
  if (now >= x.tails_due)
    publish_tails(component, now);
  return finish();
}

void supervisor::publish_tails(std::size_t component, instant now) {
  auto& x = states_[component];
  for (const auto from : {channel::out, channel::err}) {
    auto& last = x.tails[static_cast<std::size_t>(from)];
    if (!std::exchange(last.changed, false))
      continue;
    set(component, from == channel::out ? "stdout" : "stderr", last.text);
    x.tails_due = now + tail_period;
  }
}

outputs supervisor::shut_down(instant now) {
  if (std::exchange(shutting_down_, true))
    return finish();
  for (std::size_t i = 0; i < states_.size(); ++i) {
    auto& x = states_[i];
    x.wanted = false;
    if (x.at == phase::waiting)
      become(i, phase::off);
    if (x.at == phase::starting || x.at == phase::on) {
      x.step = stop_step::do_quit;
      begin_stop(i, stop_step::do_quit, now);
    }
  }
  check_all_off();
  return finish();
}

void supervisor::check_all_off() {
  const auto is_off = [](const state& x) { return x.at == phase::off; };
  if (!shutting_down_ || !std::ranges::all_of(states_, is_off))
    return;
  out_.emplace_back(notice{"all components are off"});
  out_.emplace_back(all_off{});
}

outputs supervisor::on_time(instant now) {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    auto& x = states_[i];
    if (x.at == phase::waiting && x.due <= now) {
      begin_start(i);
    } else if (x.at == phase::stopping && x.due <= now) {
      const auto next = std::min(static_cast<int>(x.step) + 1, static_cast<int>(stop_step::kill));
      take_step(i, static_cast<stop_step>(next), now);
    }
    if (x.tails_due <= now)
      publish_tails(i, now);
  }
  return finish();
}

std::optional<instant> supervisor::deadline() const {
  std::optional<instant> due;
  for (const auto& x : states_) {
    if (x.at == phase::waiting || x.at == phase::stopping)
      due = earliest(due, x.due);
    if (std::ranges::any_of(x.tails, &tail::changed))
      due = earliest(due, x.tails_due);
  }
  return due;
}

} // namespace rubicon::peisinit
