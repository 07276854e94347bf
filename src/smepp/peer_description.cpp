#include "smepp/peer_description.hpp"

#include <algorithm>
#include <cassert>
#include <optional>

#include "core/text/printable.hpp"

namespace rubicon::smepp {

namespace {

constexpr std::size_t shown_max = 32; ///< of a wrong name, in a message

/// Takes the text apart from left to right; the first problem stays.
class reader {
public:
  explicit reader(std::string_view text) : text_(text) {}

  [[nodiscard]] bool good() const { return !problem_; }
  [[nodiscard]] bool at_end() const { return at_ == text_.size(); }
  [[nodiscard]] bool sees(std::string_view x) const { return text_.substr(at_).starts_with(x); }
  [[nodiscard]] std::size_t at() const { return at_; }

  bool take(std::string_view x) {
    if (!sees(x))
      return false;
    at_ += x.size();
    return true;
  }

  void expect(std::string_view x) {
    if (good() && !take(x))
      fail("'" + std::string(x) + "' expected");
  }

  /// @returns whether there was any
  bool blanks() {
    const auto from = at_;
    while (!at_end() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
      ++at_;
    return at_ > from;
  }

  /// White space and comments.
  void between() {
    for (blanks(); good() && sees("<!--"); blanks()) {
      const auto end = text_.find("--", at_ + 4);
      if (end == std::string_view::npos)
        return fail("comment without end");
      at_ = end;
      expect("-->");
    }
  }

  /// Letters, for elements and attributes.
  std::string_view name() {
    const auto from = at_;
    while (!at_end() &&
           ((text_[at_] >= 'a' && text_[at_] <= 'z') || (text_[at_] >= 'A' && text_[at_] <= 'Z')))
      ++at_;
    if (at_ == from && good())
      fail("a name expected");
    return text_.substr(from, at_ - from);
  }

  /// In quotes of either kind, without references.
  std::string_view value() {
    const char quote = take("\"") ? '"' : take("'") ? '\'' : '\0';
    if (quote == '\0') {
      expect("\"");
      return {};
    }
    const auto from = at_;
    while (!at_end() && text_[at_] != quote) {
      if (text_[at_] == '<' || text_[at_] == '&') {
        fail("this character is not allowed here");
        return {};
      }
      ++at_;
    }
    const auto found = text_.substr(from, at_ - from);
    expect(std::string_view(&quote, 1));
    return found;
  }

  void fail(std::string message) { fail_at(at_, std::move(message)); }
  void fail_at(std::size_t at, std::string message) {
    if (problem_)
      return;
    xml_problem x;
    const auto before = text_.substr(0, at);
    x.line += static_cast<std::size_t>(std::ranges::count(before, '\n'));
    const auto line_begin = before.rfind('\n');
    x.column += line_begin == std::string_view::npos ? at : at - line_begin - 1;
    x.message = std::move(message);
    problem_ = x;
  }

  [[nodiscard]] const xml_problem& problem() const { return *problem_; }

private:
  std::string_view text_;
  std::size_t at_ = 0;
  std::optional<xml_problem> problem_;
};

std::string quoted(std::string_view x) {
  return "'" + printable(x, shown_max) + "'";
}

void read_declaration(reader& from) {
  if (!from.take("<?xml"))
    return;
  for (bool blank = from.blanks(); from.good() && !from.take("?>"); blank = from.blanks()) {
    const auto at = from.at();
    const auto name = from.name();
    if (!blank || (name != "version" && name != "encoding" && name != "standalone"))
      return from.fail_at(at, "'?>' expected");
    from.expect("=");
    static_cast<void>(from.value());
  }
}

/// The only attribute of an element, with white space before it.
std::string_view attribute(reader& from, std::string_view name, std::size_t& value_at) {
  if (!from.blanks())
    from.fail("an attribute expected");
  from.expect(name);
  from.blanks();
  from.expect("=");
  from.blanks();
  value_at = from.at() + 1;
  const auto value = from.value();
  from.blanks();
  return value;
}

mote_id read_id(reader& from) {
  std::size_t at = 0;
  const auto text = attribute(from, "id", at);
  std::uint32_t id = 0;
  for (const char c : text) {
    const bool is_digit = c >= '0' && c <= '9';
    id = is_digit ? id * 10 + static_cast<std::uint32_t>(c - '0') : mote_id_max + 1U;
    if (id > mote_id_max)
      break;
  }
  if (id < 1 || id > mote_id_max)
    from.fail_at(at, quoted(text) + " is not the id of a mote (1.." + std::to_string(mote_id_max) +
                         ")");
  return mote_id{static_cast<std::uint16_t>(id)};
}

void read_transducer(reader& from, transducer_mask& mask) {
  from.expect("<transducer");
  std::size_t at = 0;
  const auto type = attribute(from, "type", at);
  if (!from.take("/>")) {
    from.expect(">");
    from.between();
    from.expect("</transducer");
    from.blanks();
    from.expect(">");
  }
  const auto found = std::ranges::find(transducer_names, type);
  if (found == transducer_names.end())
    return from.fail_at(at, quoted(type) + " is not a transducer");
  const auto bit = transducer_mask{1} << (found - transducer_names.begin());
  if ((mask & bit) != 0)
    return from.fail_at(at, quoted(type) + " is present twice");
  mask |= bit;
}

} // namespace

std::string to_string(const xml_problem& x) {
  return std::to_string(x.line) + ':' + std::to_string(x.column) + ": " + x.message;
}

std::variant<peer_description, xml_problem> parse_peer_description(std::string_view xml) {
  reader from(xml);
  peer_description x;
  read_declaration(from);
  from.between();
  from.expect("<peer");
  x.peer = read_id(from);
  if (!from.take("/>")) {
    from.expect(">");
    for (from.between(); from.good() && !from.sees("</"); from.between())
      read_transducer(from, x.transducers);
    from.expect("</peer");
    from.blanks();
    from.expect(">");
  }
  from.between();
  if (from.good() && !from.at_end())
    from.fail("unexpected text after the peer");
  if (!from.good())
    return from.problem();
  return x;
}

std::string to_xml(const peer_description& x) {
  assert((x.transducers & ~all_transducers) == 0);
  std::string xml = "<peer id=\"" + to_string(x.peer) + "\">\n";
  for (std::size_t i = 0; i < transducer_names.size(); ++i)
    if ((x.transducers >> i & 1) != 0)
      xml.append("  <transducer type=\"").append(transducer_names[i]).append("\"/>\n");
  return xml + "</peer>\n";
}

} // namespace rubicon::smepp
