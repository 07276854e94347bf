#include "mote/gateway_lines.hpp"

#include <algorithm>

namespace rubicon::mote {

gateway_lines::gateway_lines(gateway_lines_config config, instant now, std::uint32_t last_term)
    : config_(config), term_(last_term + 1) {
  if (config.lines < 2)
    return;
  lines_.resize(config.lines);
  lines_.front().last_answer = now; // it is waited for before another one is taken
  lines_.front().steady_since = now;
  due_ = now;
}

void gateway_lines::on_answer(std::size_t line, const network::gateway_answer& x, instant now) {
  if (line >= lines_.size())
    return;
  auto& from = lines_[line];
  if (x.term > term_) { // we have been started again, and others have led since
    term_ = x.term;
    begin_term(leader_, now);
  }
  const bool is_new = from.life != x.life;
  if (is_new || !is_there(line, now))
    from.steady_since = now;
  from.last_answer = now;
  if (is_new) {
    if (from.life && line == leader_)
      begin_term(line, now); // it knows nothing of what its earlier life has received
    from.life = x.life;
    due_ = now;
  }
  review(now);
}

std::vector<line_event> gateway_lines::on_time(instant now) {
  if (!due_ || now < *due_)
    return {};
  review(now);
  due_ = now + config_.slowness * config_.poll_gap;
  std::vector<line_event> out;
  for (std::size_t i = 0; i < lines_.size(); ++i)
    out.push_back({i, {lines_[i].life.value_or(network::unknown_life), term_, i == leader_}});
  return out;
}

std::optional<instant> gateway_lines::deadline() const {
  return due_;
}

bool gateway_lines::is_there(std::size_t line, instant now) const {
  const auto& last = lines_[line].last_answer;
  return last && now - *last < config_.slowness * config_.silence_max;
}

/// The lead goes to who is there if the leader is not, and back to an earlier line that is steady.
void gateway_lines::review(instant now) {
  const bool leader_there = is_there(leader_, now);
  for (std::size_t i = 0; i < (leader_there ? leader_ : lines_.size()); ++i) {
    const bool may_lead =
        is_there(i, now) && (!leader_there || now - lines_[i].steady_since >= config_.steadiness);
    if (i != leader_ && may_lead) {
      begin_term(i, now);
      return;
    }
  }
}

void gateway_lines::begin_term(std::size_t line, instant now) {
  leader_ = line;
  ++term_;
  due_ = now;
}

} // namespace rubicon::mote
