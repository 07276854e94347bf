#include "study/outline.hpp"

#include <algorithm>

namespace rubicon::study {

namespace {

bool is_blank(char x) {
  return x == ' ' || x == '\t' || x == '\r';
}

class reader {
public:
  explicit reader(std::string_view text) : text_(text) {}

  std::vector<piece> read() {
    while (at_ < text_.size())
      read_line();
    for (const auto each : open_)
      found_[each].end = text_.size();
    return std::move(found_);
  }

private:
  [[nodiscard]] char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  [[nodiscard]] bool has(std::string_view x) const { return text_.substr(at_).starts_with(x); }

  void skip_blanks() {
    while (is_blank(peek()))
      ++at_;
  }
  void skip_line() {
    const auto end = text_.find('\n', at_);
    at_ = end == std::string_view::npos ? text_.size() : end + 1;
  }
  [[nodiscard]] std::size_t parent() const { return open_.empty() ? piece::npos : open_.back(); }

  void read_line() {
    const auto begin = at_;
    skip_blanks();
    if (peek() == '\n' || peek() == '#' || at_ == text_.size()) {
      skip_line();
      found_.push_back({piece_kind::comment, {}, begin, at_, 0, parent()});
    } else if (peek() == '[') {
      read_header(begin);
    } else {
      read_entry(begin);
    }
  }

  void read_header(std::size_t begin) {
    std::string path;
    for (; at_ < text_.size() && peek() != '\n' && peek() != '#'; ++at_)
      if (peek() != '[' && peek() != ']' && !is_blank(peek()))
        path += peek();
    skip_line();
    while (!open_.empty() && !path.starts_with(found_[open_.back()].path + '.')) {
      found_[open_.back()].end = begin;
      open_.pop_back();
    }
    found_.push_back({piece_kind::table, path, begin, at_, 0, parent()});
    open_.push_back(found_.size() - 1);
  }

  void read_entry(std::size_t begin) {
    while (peek() != '=' && peek() != '\n' && at_ < text_.size())
      peek() == '"' || peek() == '\'' ? skip_string() : static_cast<void>(++at_);
    auto key = text_.substr(begin, at_ - begin);
    while (!key.empty() && is_blank(key.back()))
      key.remove_suffix(1);
    while (!key.empty() && is_blank(key.front()))
      key.remove_prefix(1);
    if (peek() == '=')
      ++at_;
    skip_blanks();
    const auto table = parent() == piece::npos ? std::string() : found_[parent()].path + '.';
    const auto entry = found_.size();
    found_.push_back({piece_kind::entry, table + std::string(key), begin, 0, at_, parent()});
    read_value(entry);
    skip_line();
    found_[entry].end = at_;
  }

  /// To the end of its line, or of the last one.
  void read_value(std::size_t entry) {
    const bool is_array = peek() == '[';
    std::size_t depth = 0;
    std::size_t element = at_ + 1;
    for (; at_ < text_.size() && (depth > 0 || (peek() != '\n' && peek() != '#'));) {
      const char x = peek();
      if (x == '"' || x == '\'') {
        skip_string();
        continue;
      }
      if (x == '#') {
        skip_line();
        continue;
      }
      if (is_array && depth == 1 && (x == ',' || x == ']')) {
        add_element(entry, element, x == ',' ? at_ + 1 : at_);
        element = at_ + 1;
      }
      if (x == '[' || x == '{')
        ++depth;
      else if ((x == ']' || x == '}') && depth > 0)
        --depth;
      ++at_;
    }
  }

  void add_element(std::size_t entry, std::size_t begin, std::size_t end) {
    const auto inside = text_.substr(begin, end - begin);
    if (std::ranges::all_of(inside, [](char x) { return is_blank(x) || x == '\n' || x == ','; }))
      return;
    found_.push_back({piece_kind::element, found_[entry].path, begin, end, 0, entry});
  }

  void skip_string() {
    const char quote = peek();
    const std::string three(3, quote);
    const bool is_long = has(three);
    at_ += is_long ? 3 : 1;
    for (; at_ < text_.size(); ++at_) {
      if (quote == '"' && peek() == '\\')
        ++at_;
      else if (is_long ? has(three) : peek() == quote || peek() == '\n')
        break;
    }
    at_ = std::min(text_.size(), at_ + (is_long ? 3 : peek() == quote ? 1 : 0));
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<piece> found_;
  std::vector<std::size_t> open_; ///< tables whose end has not come, each within the one before
};

} // namespace

std::vector<piece> outline_of(std::string_view text) {
  return reader(text).read();
}

} // namespace rubicon::study
