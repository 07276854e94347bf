#include "serial/meaning.hpp"

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <utility>

#include "core/codec.hpp"
#include "core/text/printable.hpp"

namespace rubicon::serial {

namespace {

// AM types (docs/tinyos.md 4.4).
constexpr std::uint8_t count_type = 6; // of RadioCountToLeds and BlinkToRadio
constexpr std::uint8_t stamped_type = 0x3d;
constexpr std::uint8_t ftsp_type = 0x3e;
constexpr std::uint8_t dissemination_type = 0x60;
constexpr std::uint8_t probe_type = 0x61;
constexpr std::uint8_t printf_type = 100;
constexpr std::uint8_t ctp_beacon_type = 0x70;
constexpr std::uint8_t ctp_data_type = 0x71;
constexpr std::uint8_t oscilloscope_type = 0x93; // and of MViz

/// Says fields one after the other, ` name x` each.
class phrase {
public:
  explicit phrase(byte_reader in, std::string_view begin = {}) : in_(in), text_(begin) {}

  template <class Number>
  phrase& big(std::string_view name) {
    return say(name).say(std::to_string(in_.big<Number>()));
  }
  phrase& octet(std::string_view name) { return big<std::uint8_t>(name); }
  phrase& number(std::string_view name) { return big<std::uint16_t>(name); }

  phrase& say(std::string_view x) {
    if (!x.empty() && !text_.empty() && x.front() != ',' && x.front() != ':')
      text_ += ' ';
    text_ += x;
    return *this;
  }

  /// What is left, in hexadecimal.
  phrase& rest() {
    if (in_.remaining() > 0)
      text_ += ": " + to_hex(in_.rest());
    return *this;
  }

  [[nodiscard]] byte_reader& in() { return in_; }
  [[nodiscard]] std::string text() { return std::move(text_); }

private:
  byte_reader in_;
  std::string text_;
};

std::string count_text(byte_reader in) {
  if (in.remaining() == 2)
    return phrase(in).number("count").text();
  if (in.remaining() == 4)
    return phrase(in).number("mote").number("count").text();
  return {};
}

/// Version, interval, address and count; ten readings of Oscilloscope, fewer of
/// MultihopOscilloscope; or, of MViz, a reading, ETX (not in early ones), quality of a link, and
/// whom it leads to.
std::string oscilloscope_text(byte_reader in) {
  constexpr std::size_t shared = 8;
  constexpr std::size_t mviz = 16;
  constexpr std::size_t early_mviz = 14;
  const auto size = in.remaining();
  if (size < shared || size % 2 != 0)
    return {};
  in.skip(2); // version
  const auto interval = in.big<std::uint16_t>();
  phrase x(in);
  x.number("mote").say("interval").say(std::to_string(interval)).say("ms").say(",");
  x.number("").say("so far").say(":");
  if (size == mviz || size == early_mviz) {
    x.number("reading");
    if (size == mviz)
      x.number("etx");
    return x.number("link of").number("to").text();
  }
  while (x.in().remaining() > 0)
    x.number("");
  return x.text();
}

/// A buffer of text, filled up with zeros.
std::string printf_text(byte_reader in) {
  auto text = rubicon::to_string(in.rest());
  text.erase(std::min(text.find('\0'), text.size()));
  return "printf \"" + printable(text) + '"';
}

void say_options(phrase& x, std::uint8_t options) {
  constexpr std::uint8_t pull = 0x80;
  constexpr std::uint8_t congested = 0x40;
  if ((options & pull) != 0)
    x.say(", asks for a route");
  if ((options & congested) != 0)
    x.say(", congested");
}

/// The link estimator's header and footer, 2 octets and 3 for each link, around CTP's own 5.
std::string ctp_beacon_text(byte_reader in) {
  constexpr std::size_t bare = 5;
  constexpr std::size_t headed = 7;
  constexpr std::size_t link = 3;
  const auto size = in.remaining();
  if (size < bare)
    return {};
  const bool is_bare = size < headed;
  const std::size_t links = is_bare ? 0 : in.octet() & 0xfU;
  if (size != (is_bare ? bare : headed + links * link))
    return {};
  phrase x(in, "ctp beacon");
  if (!is_bare)
    x.octet("sequence");
  const auto options = x.in().octet();
  x.number("parent").number("etx");
  say_options(x, options);
  for (std::size_t i = 0; i < links; ++i)
    x.say(i == 0 ? ", hears" : ",").number("mote").octet("of");
  return x.text();
}

std::string ctp_data_text(byte_reader in) {
  constexpr std::size_t header = 8;
  if (in.remaining() < header)
    return {};
  const auto options = in.octet();
  const auto hops = in.octet();
  const auto etx = in.big<std::uint16_t>();
  phrase x(in, "ctp");
  x.number("origin").say("hops").say(std::to_string(hops)).say("etx").say(std::to_string(etx));
  x.octet("sequence").octet("collection");
  say_options(x, options);
  return x.rest().text();
}

std::string dissemination_text(byte_reader in) {
  constexpr std::size_t header = 6;
  if (in.remaining() < header)
    return {};
  return phrase(in, "dissemination").number("key").big<std::uint32_t>("sequence").rest().text();
}

std::string probe_text(byte_reader in) {
  return in.remaining() == 2 ? phrase(in, "dissemination probe").number("key").text()
                             : std::string();
}

/// Root, mote, sequence number, global time (docs/tinyos.md 4.4).
std::string ftsp_text(byte_reader in) {
  constexpr std::size_t size = 9;
  if (in.remaining() != size)
    return {};
  phrase x(in, "ftsp");
  return x.number("root").number("mote").octet("sequence").big<std::uint32_t>("time").text();
}

/// A payload of another type, which follows it, and 4 octets of time (docs/tinyos.md 4.4).
std::string stamped_text(const am_packet& x) {
  constexpr std::size_t footer = 5;
  if (x.payload.size() < footer)
    return {};
  const auto size = x.payload.size() - footer;
  am_packet inner = x;
  inner.payload.resize(size);
  byte_reader in(byte_view(x.payload).subspan(size));
  inner.am_type = in.octet();
  auto text = phrase(in, "stamped").big<std::uint32_t>("").text() + " type " +
              std::to_string(inner.am_type);
  if (inner.am_type == stamped_type) // they are not nested
    return text;
  const auto meaning = meaning_of(inner);
  return meaning.empty() ? text : text + ", " + meaning;
}

} // namespace

std::string meaning_of(const am_packet& x) {
  const byte_reader in(x.payload);
  switch (x.am_type) {
  case count_type:
    return count_text(in);
  case oscilloscope_type:
    return oscilloscope_text(in);
  case printf_type:
    return printf_text(in);
  case ctp_beacon_type:
    return ctp_beacon_text(in);
  case ctp_data_type:
    return ctp_data_text(in);
  case dissemination_type:
    return dissemination_text(in);
  case probe_type:
    return probe_text(in);
  case ftsp_type:
    return ftsp_text(in);
  case stamped_type:
    return stamped_text(x);
  }
  return {};
}

} // namespace rubicon::serial
