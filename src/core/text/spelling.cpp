#include "core/text/spelling.hpp"

#include <algorithm>

namespace rubicon {

namespace {

constexpr std::size_t names_listed_max = 10;
constexpr std::size_t length_compared_max = 64;
constexpr std::size_t known_compared_max = 2000; // more would take long for each mistake

char folded(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool same(char a, char b) {
  return folded(a) == folded(b);
}

} // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last;
  std::vector<std::size_t> last(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j)
    last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::vector<std::size_t> row(b.size() + 1, i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (same(a[i - 1], b[j - 1]) ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]))
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last = std::move(last);
    last = std::move(row);
  }
  return last.back();
}

std::string nearest(std::string_view word, const std::vector<std::string>& known) {
  if (word.size() > length_compared_max || known.size() > known_compared_max)
    return {};
  const auto far = std::max<std::size_t>(1, std::min<std::size_t>(3, word.size() / 3));
  std::string best;
  auto best_distance = far + 1;
  for (const auto& candidate : known) {
    const auto distance =
        candidate.size() > length_compared_max ? best_distance : edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& known) {
  if (known.empty())
    return ": there is none";
  if (const auto meant = nearest(word, known); !meant.empty())
    return ": did you mean `" + meant + "`?";
  std::string text = ": there is ";
  for (std::size_t i = 0; i < known.size() && i < names_listed_max; ++i)
    text += (i == 0 ? "" : ", ") + known[i];
  return known.size() > names_listed_max ? text + ", ..." : text;
}

} // namespace rubicon
