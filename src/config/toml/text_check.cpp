#include "config/toml/text_check.hpp"

#include <cstdint>
#include <string>

namespace rubicon::config {

namespace {

/// Walks through a text and knows what is string, comment or neither.
///
///   outside --#--> comment --newline--> outside
///   outside --quote--> line_string --same quote or newline--> outside
///   outside --three quotes--> block_string --three same quotes--> outside
class scanner {
public:
  explicit scanner(std::string_view text) : text_(text) {}

  std::optional<mark> run() {
    for (; at_ < text_.size(); advance()) {
      if (where_ == state::outside)
        outside();
      else
        inside();
      if (dots_ > key_dots_max)
        return place_;
    }
    return std::nullopt;
  }

private:
  enum class state : std::uint8_t { outside, comment, line_string, block_string };

  void advance(std::size_t octets = 1) {
    for (; octets > 0 && at_ < text_.size(); --octets, ++at_) {
      if (text_[at_] == '\n')
        place_ = {place_.line + 1, 1};
      else if ((static_cast<unsigned char>(text_[at_]) & 0xc0U) != 0x80U) // not in a character
        ++place_.column;
    }
  }

  [[nodiscard]] bool three_quotes() const {
    return text_.substr(at_).starts_with(std::string(3, quote_));
  }

  void outside() {
    const char c = text_[at_];
    if (c == '.') {
      ++dots_;
    } else if (c == '#') {
      where_ = state::comment;
    } else if (c == '"' || c == '\'') {
      quote_ = c;
      where_ = three_quotes() ? state::block_string : state::line_string;
      advance(where_ == state::block_string ? 2 : 0);
    } else if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos) {
      dots_ = 0;
    }
  }

  void inside() {
    const char c = text_[at_];
    if (c == '\n' && where_ != state::block_string) {
      where_ = state::outside;
      dots_ = 0;
    } else if (where_ != state::comment && c == '\\' && quote_ == '"') {
      advance(text_.substr(at_ + 1).starts_with('\n') ? 0 : 1);
    } else if (where_ == state::line_string && c == quote_) {
      where_ = state::outside;
    } else if (where_ == state::block_string && three_quotes()) {
      where_ = state::outside;
      advance(2);
      for (int i = 0; i < 2 && text_.substr(at_ + 1).starts_with(quote_); ++i)
        advance(); // quotes that belong to the string may stand before its last three
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  mark place_{1, 1};
  state where_ = state::outside;
  char quote_ = '"';
  std::size_t dots_ = 0; ///< of the key, or the number, that is read
};

} // namespace

std::optional<mark> overlong_key(std::string_view text) {
  return scanner(text).run();
}

} // namespace rubicon::config
