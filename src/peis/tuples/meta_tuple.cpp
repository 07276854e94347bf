#include "peis/tuples/meta_tuple.hpp"

#include <charconv>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr std::string_view blanks = " \t\n\v\f\r";

void skip_blanks(std::string_view& rest) {
  rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
}

bool take(std::string_view& rest, std::string_view expected) {
  skip_blanks(rest);
  if (!rest.starts_with(expected))
    return false;
  rest.remove_prefix(expected.size());
  return true;
}

/// Up to the next blank.
std::string_view take_word(std::string_view& rest) {
  skip_blanks(rest);
  const auto word = rest.substr(0, rest.find_first_of(blanks));
  rest.remove_prefix(word.size());
  return word;
}

std::optional<std::int32_t> to_number(std::string_view word) {
  std::int32_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc() || end != word.data() + word.size())
    return std::nullopt;
  return value;
}

} // namespace

result<meta_reference> parse_meta(std::string_view text) {
  auto rest = text;
  if (!take(rest, "(") || !take(rest, "META") || rest.find_first_of(blanks) != 0)
    return errc::bad_value;
  const auto owner = to_number(take_word(rest));
  auto name = take_word(rest);
  const bool closed = name.ends_with(')');
  if (closed)
    name.remove_suffix(1);
  else
    static_cast<void>(take(rest, ")"));
  skip_blanks(rest);
  if (!owner || name.empty() || !rest.empty())
    return errc::bad_value;
  if (*owner == any_peer.value)
    return meta_reference();
  auto target = key::parse(name);
  if (*owner <= 0 || !target || target->is_pattern())
    return errc::bad_value;
  return meta_reference(meta_target{peer_id{*owner}, std::move(*target)});
}

std::string format_meta(const meta_reference& x) {
  if (!x)
    return "(META -1 NULL)";
  return "(META " + to_string(x->owner) + ' ' + x->name.text() + ')';
}

tuple_content meta_content(const meta_reference& x) {
  auto content = text_content(format_meta(x));
  content.mimetype = meta_mimetype;
  return content;
}

result<meta_reference> read_meta(const tuple& x) {
  if (x.mimetype != meta_mimetype)
    return errc::bad_value;
  return parse_meta(x.text());
}

std::string meta_key_of(std::string_view input) {
  const auto dot = input.rfind('.');
  const auto last = dot == std::string_view::npos ? 0 : dot + 1;
  return std::string(input.substr(0, last)) + "mi-" + std::string(input.substr(last));
}

} // namespace rubicon::peis
