#include "proxy/classes/class_change.hpp"

#include <algorithm>
#include <cassert>

#include "core/text/decimal.hpp"

namespace rubicon::proxy {

namespace {

template <class T, class To>
void set(const std::optional<T>& from, To& to) {
  if (from)
    to = *from;
}

void say(std::string what, std::string& text) {
  text += (text.empty() ? "" : ", ") + std::move(what);
}

} // namespace

void apply(const class_change& x, proxy_class& to) {
  set(x.answer_timeout, to.settings.answer_timeout);
  set(x.retry_for, to.settings.retry_for);
  set(x.period, to.settings.period);
  set(x.stale_after, to.settings.stale_after);
  set(x.inactive_after, to.settings.inactive_after);
  set(x.retire_after, to.settings.retire_after);
  if (x.field.empty())
    return;
  const auto found = std::ranges::find(to.fields, x.field, &field::name);
  assert(found != to.fields.end());
  set(x.unit, found->unit);
  set(x.scale, found->scale);
  set(x.add, found->add);
  set(x.decimals, found->decimals);
}

std::string to_text(const class_change& x) {
  std::string text;
  const auto time = [&text](const char* name, const std::optional<duration>& value) {
    if (value)
      say(std::string(name) + ' ' + rubicon::to_text(*value), text);
  };
  time("answer_timeout", x.answer_timeout);
  time("retry_for", x.retry_for);
  time("period", x.period);
  time("stale_after", x.stale_after);
  time("inactive_after", x.inactive_after);
  time("retire_after", x.retire_after);
  if (x.unit)
    say(x.field + " in " + *x.unit, text);
  if (x.scale)
    say("scale of " + x.field + ' ' + shortest_decimal(*x.scale), text);
  if (x.add)
    say("add of " + x.field + ' ' + shortest_decimal(*x.add), text);
  if (x.decimals)
    say("decimals of " + x.field + ' ' + std::to_string(*x.decimals), text);
  return text;
}

} // namespace rubicon::proxy
