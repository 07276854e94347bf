#include <string>
#include <utility>
#include <vector>

#include "config/file_readers.hpp"
#include "translate/pattern.hpp"
#include "translate/translation_keys.hpp"

namespace rubicon::config {

namespace {

/// A key in which {1} stands for what the first `*` does.
struct target_key {
  using type = std::string;
  std::size_t stars = 0;

  [[nodiscard]] std::optional<std::string> read(const node& x, const asker& who) const {
    const auto* found = x.as<std::string>();
    if (found != nullptr && translate::is_target(*found, stars))
      return *found;
    auto wanted = std::string("1 to 7 parts between dots, at most 127 characters, each of letters, "
                              "digits, - and _");
    if (stars > 0)
      wanted += ", and {1}" + (stars > 1 ? " to {" + std::to_string(stars) + '}' : std::string()) +
                ", which the `*` of `from` stand for";
    return who.refuse(x, wanted);
  }
  [[nodiscard]] static form takes() { return string_form("tuple key"); }
};

/// Arithmetic on `x`.
struct arithmetic {
  using type = translate::expression;

  [[nodiscard]] static std::optional<type> read(const node& x, const asker& who) {
    const auto* found = x.as<std::string>();
    if (found == nullptr)
      return who.refuse(x, "an expression in text, as in \"(x - 400) * 0.5\"");
    auto parsed = translate::expression::parse(*found);
    if (auto* good = std::get_if<type>(&parsed))
      return std::move(*good);
    const auto& wrong = std::get<translate::expression_problem>(parsed);
    who.complain(x, '`' + std::string(who.key) + "`, at character " + std::to_string(wrong.at + 1) +
                        " of " + in_quotes(*found) + ": " + wrong.message);
    return std::nullopt;
  }
  [[nodiscard]] static form takes() { return string_form("text of up to 200 octets"); }
};

auto translation_from_keys() {
  return keys::of(keys::required("from", &translate::translation::from, tuple_key{true},
                                 "of any owner; a part may be `*`, which stands for any one part"));
}

/// @param stars parts of `from` that are `*`
auto translation_target_keys(std::size_t stars) {
  return keys::of(
      keys::optional(
          "to", &translate::translation::to, target_key{stars},
          {"the published tuple; `{1}` is the part that the first `*` stands for", "none"}),
      keys::optional(
          "value", &translate::translation::value, arithmetic{},
          {"arithmetic on the number `x` in the tuple: `+`, `-`, `*`, `/`, parentheses, `abs(a)`, "
           "`floor(a)`, `ceil(a)`, `round(a)`, `sqrt(a)`, `min(a, b)`, `max(a, b)`. Values that "
           "are not numbers are dropped and counted, as are results that are not finite",
           "the text, unchanged"}));
}

translate::translation read_translation(table_reader& in) {
  translate::translation out;
  in.all(out, translation_from_keys());
  in.all(out, translation_target_keys(translate::stars_in(out.from)));
  in.all(out);
  if (!in.has("to") && !in.has("history"))
    in.problems().add(in.at(), "a translation needs `to`, `history` or both");
  if (in.has("decimals") && !in.has("value"))
    in.problems().add(in.at("decimals"), "`decimals` need a `value`");
  if (in.has("unit") && !in.has("to"))
    in.problems().add(in.at("unit"), "`unit` needs `to`");
  auto& seen = in.shared().seen;
  if (!out.from.empty())
    seen.uses.push_back({"a translation of " + seen.peer + " reads", out.from, in.at("from")});
  return out;
}

} // namespace

translate_app read_translate(table_reader& in) {
  translate_app out;
  in.tables(
      "rules", "rules of a translation", "see below; also as `[[peer.apps.rules]]`",
      [&](table_reader& x) { out.rules.push_back(read_translation(x)); }, 1);
  return out;
}

} // namespace rubicon::config
