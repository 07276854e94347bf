#include "cli/manual/roff.hpp"

#include <sstream>

namespace rubicon::cli::roff {

namespace {

constexpr std::size_t line_max = 78;

/// A line of text is no request.
std::string text_line(std::string line) {
  return (line.starts_with('.') || line.starts_with('\'') ? "\\&" : "") + std::move(line) + '\n';
}

} // namespace

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
    case '\\':
      out += "\\e";
      break;
    case '-':
      out += "\\-";
      break;
    case '\'':
      out += "\\(aq";
      break;
    case '`':
      out += "\\(ga";
      break;
    case '^':
      out += "\\(ha";
      break;
    case '~':
      out += "\\(ti";
      break;
    default:
      out += c;
    }
  }
  return out;
}

std::string bold(std::string_view text) {
  return "\\fB" + escaped(text) + "\\fR";
}

std::string italic(std::string_view text) {
  return "\\fI" + escaped(text) + "\\fR";
}

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : escaped(text))
    out += c == '"' ? std::string("\\(dq") : std::string(1, c);
  return out + '"';
}

std::string filled(std::string_view text) {
  std::istringstream words{std::string(text)};
  std::string out;
  std::string line;
  for (std::string word; words >> word;) {
    word = escaped(word);
    if (!line.empty() && line.size() + 1 + word.size() > line_max) {
      out += text_line(std::move(line));
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return line.empty() ? out : out + text_line(std::move(line));
}

std::string literal(std::string_view lines) {
  std::istringstream in{std::string(lines)};
  std::string out = ".nf\n";
  for (std::string line; std::getline(in, line);)
    out += text_line(escaped(line));
  return out + ".fi\n";
}

std::string paragraphs(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto end = text.find("\n\n");
    const auto part = text.substr(0, end);
    out += out.empty() ? "" : ".PP\n";
    out += part.find("\n  ") == std::string_view::npos ? filled(part) : literal(part);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 2);
  }
  return out;
}

} // namespace rubicon::cli::roff
