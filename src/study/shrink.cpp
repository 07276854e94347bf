#include "study/shrink.hpp"

#include <algorithm>
#include <cassert>
#include <string_view>
#include <utility>

namespace rubicon::study {

namespace {

constexpr std::string_view length_path = "ecology.duration";

/// `"37.5s"` with one digit that counts: `"30.0s"`; nothing if it has no more, or is no number.
std::optional<std::string> with_one_digit(std::string_view value) {
  std::string out(value);
  std::size_t i = out.starts_with('"') ? 1 : 0;
  if (i < out.size() && out[i] == '-')
    ++i;
  if (i == out.size() || out[i] < '0' || out[i] > '9')
    return std::nullopt;
  bool has_digit = false;
  bool changes = false;
  for (; i < out.size() && ((out[i] >= '0' && out[i] <= '9') || out[i] == '.'); ++i) {
    if (out[i] == '.' || out[i] == '0')
      continue;
    if (has_digit) {
      out[i] = '0';
      changes = true;
    }
    has_digit = true;
  }
  return changes ? std::optional(out) : std::nullopt;
}

} // namespace

shrinker::shrinker(std::string text, std::uint64_t length_s, std::uint64_t seen_s)
    : text_(std::move(text)), pieces_(outline_of(text_)), seen_s_(seen_s) {
  now_.is_out.resize(pieces_.size());
  now_.length_s = length_s;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    now_.is_out[i] = pieces_[i].what == piece_kind::comment;
    if (pieces_[i].what == piece_kind::entry && pieces_[i].path == length_path)
      length_entry_ = i;
  }
  at_round_ = now_;
  begin(pass::faults);
}

bool shrinker::belongs(const piece& x, pass to) {
  const bool is_table = x.what == piece_kind::table;
  const bool is_fault = is_table && (x.path == "fault" || x.path == "change");
  const bool is_mote = is_table && x.path.starts_with("island.");
  const bool is_peer = is_table && (x.path == "peer" || x.path.starts_with("peer."));
  switch (to) {
  case pass::faults:
    return is_fault;
  case pass::motes:
    return is_mote;
  case pass::programs:
    return x.what == piece_kind::element && x.path.ends_with(".apps");
  case pass::peers:
    return is_peer;
  case pass::tables:
    return is_table && !is_fault && !is_mote && !is_peer;
  case pass::entries:
    return x.what == piece_kind::entry && x.path != length_path;
  case pass::elements:
    return x.what == piece_kind::element;
  case pass::digits:
    return x.what == piece_kind::entry && x.path != length_path;
  case pass::length:
  case pass::ended:
    break;
  }
  return false;
}

kept shrinker::count(pass of) const {
  kept out;
  for (std::size_t i = 0; i < pieces_.size(); ++i)
    if (belongs(pieces_[i], of)) {
      ++out.of;
      out.left += is_out(now_, i) ? 0 : 1;
    }
  return out;
}

bool shrinker::is_out(const version& x, std::size_t piece) const {
  for (; piece != piece::npos; piece = pieces_[piece].parent)
    if (x.is_out[piece])
      return true;
  return false;
}

std::string shrinker::text_of(const version& x) const {
  std::string out;
  std::size_t at = 0;
  const auto skip_to = [&](std::size_t begin, std::size_t end) {
    if (begin > at)
      out.append(text_, at, begin - at);
    at = std::max(at, end);
  };
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const auto& each = pieces_[i];
    if (each.begin < at)
      continue;
    if (x.is_out[i]) {
      skip_to(each.begin, each.end);
    } else if (x.length_s > 0 && i == length_entry_) {
      skip_to(each.value, each.end);
      out += '"' + std::to_string(x.length_s) + "s\"\n";
    } else if (const auto value = x.values.find(i); value != x.values.end()) {
      skip_to(each.value, each.end);
      out += value->second;
    }
  }
  skip_to(text_.size(), text_.size());
  return out;
}

void shrinker::begin(pass x) {
  pass_ = x;
  list_.clear();
  for (std::size_t i = 0; i < pieces_.size(); ++i)
    if (belongs(pieces_[i], x) && !is_out(now_, i))
      list_.push_back(i);
  size_ = std::max<std::size_t>(1, list_.size());
  place_ = 0;
}

void shrinker::begin_next() {
  const auto after = static_cast<pass>(static_cast<unsigned>(pass_) + 1);
  if (after == pass::ended && now_ != at_round_) {
    at_round_ = now_;
    return begin(pass::faults);
  }
  begin(after);
}

std::optional<shrinker::version> shrinker::next_length() {
  constexpr std::uint64_t steps = 20; // an accuracy of a twentieth
  if (!length_entry_ ||
      now_.length_s - too_short_s_ <= std::max<std::uint64_t>(1, now_.length_s / steps))
    return std::nullopt;
  auto x = now_;
  x.length_s = seen_s_ > too_short_s_ && seen_s_ < now_.length_s
                   ? seen_s_
                   : too_short_s_ + (now_.length_s - too_short_s_) / 2;
  return x;
}

std::optional<shrinker::version> shrinker::next_removal() {
  while (place_ >= list_.size()) {
    if (size_ <= 1)
      return std::nullopt;
    size_ = (size_ + 1) / 2;
    place_ = 0;
    if (list_.empty())
      return std::nullopt;
  }
  auto x = now_;
  for (auto i = place_; i < std::min(list_.size(), place_ + size_); ++i)
    x.is_out[list_[i]] = true;
  return x;
}

std::optional<shrinker::version> shrinker::next_digits() {
  for (; place_ < list_.size(); ++place_) {
    const auto& each = pieces_[list_[place_]];
    const auto value = std::string_view(text_).substr(each.value, each.end - each.value);
    if (auto shorter = with_one_digit(value); shorter && !now_.values.contains(list_[place_])) {
      auto x = now_;
      x.values[list_[place_]] = *std::move(shorter);
      return x;
    }
  }
  return std::nullopt;
}

std::optional<std::string> shrinker::next() {
  while (pass_ != pass::ended && tries_ < tries_max) {
    auto x = pass_ == pass::length   ? next_length()
             : pass_ == pass::digits ? next_digits()
                                     : next_removal();
    if (x) {
      ++tries_;
      tried_ = *std::move(x);
      return text_of(tried_);
    }
    begin_next();
  }
  return std::nullopt;
}

void shrinker::take(bool happens) {
  if (pass_ == pass::length) {
    if (happens)
      now_ = tried_;
    else
      too_short_s_ = tried_.length_s;
    return;
  }
  if (happens)
    now_ = tried_;
  if (pass_ == pass::digits) {
    ++place_;
  } else if (happens) { // also what is in them: it stands behind them
    std::erase_if(list_, [this](std::size_t x) { return is_out(now_, x); });
  } else {
    place_ += size_;
  }
}

} // namespace rubicon::study
