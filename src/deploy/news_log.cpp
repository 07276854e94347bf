#include "deploy/news_log.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::deploy {

void news_log::add(std::string line) {
  if (line.size() > line_octets_max)
    line.resize(line_octets_max);
  lines_.push_back(std::move(line));
  ++last_;
  if (lines_.size() > lines_max)
    lines_.pop_front();
}

news_log::page news_log::after(std::uint64_t number) const {
  const auto gone = last_ - lines_.size();
  const auto from = std::clamp(number, gone, last_); // a number of another log may be any
  return {{lines_.begin() + static_cast<std::ptrdiff_t>(from - gone), lines_.end()},
          last_,
          number < gone ? gone - number : 0};
}

} // namespace rubicon::deploy
