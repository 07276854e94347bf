#include "explain/print/words.hpp"

#include <algorithm>

#include "explain/outcome.hpp"
#include "network/am.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::explain {

namespace {

constexpr std::size_t octets_shown = 12;
constexpr std::size_t characters_shown = 40;

std::string hex_text(const bytes& value) {
  const auto shown = byte_view(value).first(std::min(value.size(), octets_shown));
  return to_hex(shown) + (shown.size() < value.size() ? "…" : "");
}

const char* name_of(medium x) {
  switch (x) {
  case medium::air:
    return "radio";
  case medium::serial:
    return "serial line";
  case medium::backbone:
    return "backbone";
  case medium::peis:
    return "PEIS";
  case medium::none:
    break;
  }
  return "";
}

std::string hop_text(const node& x) {
  auto text = std::string(name_of(x.over));
  if (x.fragments > 1)
    text += ", " + std::to_string(x.fragments) + " fragments";
  if (!x.arrived)
    return text + ": LOST, " + obstacle(x);
  if (x.to.empty() && x.receivers.size() > 1)
    text += ": received by " + std::to_string(x.receivers.size());
  else
    text += ": received";
  const auto repeated = repeats(x);
  if (repeated == 0)
    return text;
  auto why = failures(x);
  const auto there = std::ranges::count_if(x.attempts, &attempt::arrived);
  if (const auto again = there - static_cast<std::ptrdiff_t>(x.fragments); again > 0)
    why += (why.empty() ? "" : ", ") + (again > 1 ? std::to_string(again) + " × " : "") +
           "acknowledgement lost";
  return text + " after " + report::counted(repeated, "repeat") + " (" + why + ')';
}

} // namespace

std::string value_text(const bytes& value, bool is_text) {
  if (!is_text)
    return value.empty() ? "nothing" : hex_text(value);
  const auto text = report::printable(rubicon::to_string(byte_view(value)));
  return text.empty() ? "\"\"" : report::cut(text, characters_shown);
}

std::string assignment(const tuple_value& x) {
  const auto key = report::printable(x.key);
  return x.is_deletion ? key + ", deleted" : key + " = " + value_text(x.value, x.is_text);
}

bool is_event(const message& x) {
  return x.channel == network::am::smepp && !x.is_on_channel && !x.is_in_tunnel && !x.content;
}

std::string content_text(const message& x) {
  if (is_event(x))
    return "an event";
  if (!x.content)
    return "content unknown";
  const auto& octets = *x.content;
  const bool is_text = octets.size() > 3 && std::ranges::all_of(octets, [](std::uint8_t c) {
                         return c >= 0x20 && c < 0x7f;
                       });
  return report::counted(octets.size(), "octet") +
         (octets.empty()
              ? ""
              : " (" + (is_text ? '"' + value_text(octets, true) + '"' : hex_text(octets)) + ')');
}

std::string kind_of(const message& x) {
  if (is_event(x))
    return "SMEPP, encrypted";
  if (x.is_in_tunnel)
    return "through a tunnel";
  if (x.is_on_channel)
    return "channel " + std::to_string(x.channel);
  return "AM type " + std::to_string(x.channel) + (x.is_reliable ? ", reliable" : ", unreliable");
}

std::string where(const traces& all, const node& x) {
  switch (x.what) {
  case step::hop:
    return route_of(x);
  case step::sends:
    return all.known.of(all.messages[x.about.index].source);
  case step::receives:
  case step::acts:
  case step::learns:
  case step::asks:
  case step::sets:
  case step::notified:
    break;
  }
  return names::of(x.from);
}

std::string what(const traces& all, const node& x) {
  switch (x.what) {
  case step::hop:
    return (x.of == cargo::greeting  ? "greeting, "
            : x.of == cargo::content ? std::string()
                                     : x.text + ", ") +
           hop_text(x);
  case step::sends: {
    const auto& m = all.messages[x.about.index];
    const auto program = names::of(x.from);
    const auto who = all.known.of(m.source);
    const bool is_named = !m.program.empty() && program.size() > who.size();
    return (is_named ? program.substr(program.rfind('/') + 1) + " sends " : "sends ") +
           content_text(m) + " to " + all.known.of(m.destination) + ": " + kind_of(m);
  }
  case step::receives:
    return "has the message";
  case step::acts:
    return report::printable(x.text);
  case step::learns:
    return x.text == "acknowledged" ? "receives the acknowledgement" : "is notified: " + x.text;
  case step::asks: {
    const auto& tuple = all.tuples[x.about.index];
    return "writes " + assignment(tuple) + " at " + all.known.of(tuple.owner);
  }
  case step::sets:
    if (all.nodes[all.tuples[x.about.index].root].what == step::asks)
      return "now has this value";
    return (all.tuples[x.about.index].is_deletion ? "" : "sets ") +
           assignment(all.tuples[x.about.index]);
  case step::notified:
    return "receives it";
  }
  return {};
}

std::string span(duration x) {
  const auto ms = std::chrono::duration<double, std::milli>(x).count();
  return ms < 1000 ? report::fixed(ms, 1) + " ms" : report::fixed(ms / 1000, 1) + " s";
}

} // namespace rubicon::explain
