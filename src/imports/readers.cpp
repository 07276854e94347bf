#include "imports/readers.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <utility>

#include "core/text/decimal.hpp"

namespace rubicon::imports {

void refuse(text_place at, std::string message) {
  throw mistake{{at, std::move(message)}};
}

std::string quoted(std::string_view x) {
  constexpr std::size_t shown_max = 40;
  std::string out = "\"";
  for (const char c : x.substr(0, shown_max))
    out += c >= ' ' && c <= '~' ? c : '?';
  return out + (x.size() > shown_max ? "...\"" : "\"");
}

text_place place_of(std::string_view text, std::size_t offset) {
  const auto before = text.substr(0, std::min(offset, text.size()));
  const auto line = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
  const auto last = before.rfind('\n');
  return {line + 1, before.size() - (last == std::string_view::npos ? 0 : last + 1) + 1};
}

namespace {

constexpr std::size_t block_octets = 4096; // of place_finder
constexpr std::size_t notes_max = 200;

} // namespace

place_finder::place_finder(std::string_view text) : text_(text), blocks_(1) {
  for (std::size_t begin = 0; begin + block_octets <= text.size(); begin += block_octets) {
    auto next = blocks_.back();
    const auto octets = text.substr(begin, block_octets);
    next.line += static_cast<std::size_t>(std::count(octets.begin(), octets.end(), '\n'));
    if (const auto last = octets.rfind('\n'); last != std::string_view::npos)
      next.line_begin = begin + last + 1;
    blocks_.push_back(next);
  }
}

text_place place_finder::at(std::size_t offset) const {
  offset = std::min(offset, text_.size());
  const auto number = offset / block_octets;
  const auto& known = blocks_[number];
  const auto begin = number * block_octets;
  const auto here = place_of(text_.substr(begin), offset - begin);
  return {known.line + here.line - 1, here.line > 1 ? here.column : offset - known.line_begin + 1};
}

bool line_fields::next() {
  if (rest_.empty())
    return false;
  const auto end = rest_.find('\n');
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (line_.ends_with('\r'))
    line_.remove_suffix(1);
  ++number_;
  fields_.clear();
  if (separators_.empty())
    split_at_commas();
  else
    split();
  return true;
}

void line_fields::split() {
  for (std::size_t at = 0; at < line_.size();) {
    const auto begin = line_.find_first_not_of(separators_, at);
    if (begin == std::string_view::npos)
      break;
    const auto end = std::min(line_.find_first_of(separators_, begin), line_.size());
    fields_.push_back({line_.substr(begin, end - begin), {number_, begin + 1}});
    at = end;
  }
}

void line_fields::split_at_commas() {
  for (std::size_t begin = 0; !line_.empty();) {
    const auto end = std::min(line_.find(',', begin), line_.size());
    fields_.push_back({line_.substr(begin, end - begin), {number_, begin + 1}});
    if (end == line_.size())
      break;
    begin = end + 1;
  }
}

std::optional<std::uint64_t> whole_in(std::string_view x) {
  std::uint64_t out = 0;
  const auto [end, error] = std::from_chars(x.data(), x.data() + x.size(), out);
  if (error != std::errc() || end != x.data() + x.size())
    return std::nullopt;
  return out;
}

double real_of(const field& x, std::string_view what, double least, double most) {
  const bool has_plus = x.text.starts_with('+') && !x.text.starts_with("+-");
  const auto found = number_in(x.text.substr(has_plus ? 1 : 0));
  if (!found || *found < least || *found > most)
    refuse(x.at, std::string(what) + " must be a number from " +
                     std::to_string(static_cast<long>(least)) + " to " +
                     std::to_string(static_cast<long>(most)) + ", not " + quoted(x.text));
  return *found;
}

double coordinate_of(const field& x, std::string_view what) {
  return real_of(x, what, -coordinate_max_m, coordinate_max_m);
}

std::uint32_t node_of(const field& x) {
  const auto found = whole_in(x.text);
  if (!found || *found > node_max)
    refuse(x.at, "a node must be a number from 0 to " + std::to_string(node_max) + ", not " +
                     quoted(x.text));
  return static_cast<std::uint32_t>(*found);
}

void note_list::add(text_place at, const std::string& what) {
  if (first_.size() < notes_max)
    first_.try_emplace(what, at);
  else
    is_full_ = is_full_ || !first_.contains(what);
}

std::vector<left_out> note_list::sorted() const {
  std::vector<left_out> out;
  for (const auto& [what, at] : first_)
    out.push_back({at, what});
  if (is_full_)
    out.push_back({{}, "kinds of things beyond the " + std::to_string(notes_max) + " listed here"});
  std::ranges::stable_sort(out, {},
                           [](const left_out& x) { return std::pair(x.at.line, x.at.column); });
  return out;
}

std::size_t mote_list::by_number(std::uint32_t number, text_place at) {
  const auto [found, is_new] = numbers_.try_emplace(number, all_.size());
  if (is_new && all_.size() == motes_max)
    refuse(at, "there are more than " + std::to_string(motes_max) + " motes");
  if (is_new)
    all_.push_back({number, {}, {}, {}, {}});
  return found->second;
}

std::size_t mote_list::by_name(std::string_view name, text_place at) {
  if (const auto found = names_.find(name); found != names_.end())
    return found->second;
  const auto next = numbers_.empty() ? 1 : numbers_.rbegin()->first + 1;
  const auto index = by_number(next, at);
  all_[index].name = name;
  names_.emplace(name, index);
  return index;
}

void mote_list::give(ecology_plan& to) {
  if (all_.empty())
    refuse({}, "there is no mote in it");
  std::vector<std::size_t> order(all_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [this](std::size_t i) { return all_[i].number; });
  std::vector<std::size_t> place(all_.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[order[i]] = i;
    to.motes.push_back(std::move(all_[order[i]]));
  }
  for (auto& x : to.links) {
    x.from = place[x.from];
    x.to = place[x.to];
  }
  for (auto& x : to.changes) {
    x.from = place[x.from];
    x.to = place[x.to];
  }
}

imported finished(imported x, mote_list& motes, const note_list& notes) {
  motes.give(x.plan);
  x.notes = notes.sorted();
  return x;
}

} // namespace rubicon::imports
