// Expressions as somebody writes them into a file: whatever the text, it is an expression that can
// be evaluated, or it has a problem that lies in the text. The rest of the same octets are keys.
#include <cmath>
#include <cstdint>
#include <string_view>
#include <variant>

#include "require.hpp"
#include "translate/expression.hpp"
#include "translate/pattern.hpp"
#include "translate/translator.hpp"

namespace {

using namespace rubicon;

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto parsed = translate::expression::parse(text);
  if (const auto* good = std::get_if<translate::expression>(&parsed)) {
    require(size <= translate::expression::text_max);
    for (const double x : {0.0, 1.0, -3.5, 1e300})
      if (const auto value = (*good)(x))
        require(std::isfinite(*value));
  } else {
    const auto& wrong = std::get<translate::expression_problem>(parsed);
    require(wrong.at <= size && !wrong.message.empty());
  }

  if (translate::is_target(text, 2)) {
    const auto key = translate::filled(text, {"a", "b"});
    require(translate::match(key, key).has_value());
  }
  const auto stars = translate::match(text, text);
  require(stars && stars->size() == translate::stars_in(text));

  translate::translator aut({{"a.*", "b.{1}", {}, 2, "V", 3}});
  static_cast<void>(aut.on_value("a.x", text, false, instant{}));
  static_cast<void>(aut.on_value(text, "1", false, instant{}));
  require(aut.targets() <= 2);
  return 0;
}
