#include "cli/manual/manual_page.hpp"

#include <cctype>

#include "cli/manual/roff.hpp"
#include "cli/manual/value_kind.hpp"

namespace rubicon::cli {

namespace {

std::string section(std::string_view name) {
  return ".SH " + roff::quoted(name) + '\n';
}

std::string head(const std::string& name, const std::string& number, const std::string& about,
                 const manual_edition& edition) {
  std::string title;
  for (const char c : name)
    title += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  auto sentence = about;
  if (!sentence.empty())
    sentence[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(sentence[0])));
  return ".\\\" Written by `rubicon help --pages` from the descriptions of commands and "
         "keys.\n.TH " +
         roff::quoted(title) + ' ' + number + ' ' + edition.date + ' ' +
         roff::quoted("rubicon " + edition.version) + ' ' +
         roff::quoted(number == "1" ? "User Commands" : "File Formats") + '\n' + section("NAME") +
         roff::escaped(name) + " \\- " + roff::escaped(sentence) + '\n';
}

/// `--for TIME`, `--view[=PORT]`, `FILE`
std::string option_head(const option_description& x, bool is_argument) {
  std::string out;
  for (const auto& name : x.names)
    out += (out.empty() ? "" : ", ") + (is_argument ? roff::italic(name) : roff::bold(name));
  if (x.value.empty())
    return out;
  return out +
         (x.has_optional_value ? "[=" + roff::italic(x.value) + ']' : ' ' + roff::italic(x.value));
}

std::string listed(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words)
    out += (out.empty() ? "" : ", ") + word;
  return out;
}

/// `required; one of a, b`
std::string notes_of(const option_description& x) {
  std::string out;
  const auto add = [&out](const std::string& note) { out += (out.empty() ? "" : "; ") + note; };
  if (x.is_required)
    add("required");
  if (!x.words.empty())
    add("one of " + listed(x.words));
  if (!x.range.empty())
    add(x.range);
  if (!x.needs.empty())
    add("needs " + listed(x.needs));
  if (!x.excludes.empty())
    add("not with " + listed(x.excludes));
  return out;
}

std::string row(const option_description& x, bool is_argument) {
  const auto notes = notes_of(x);
  return ".TP\n" + option_head(x, is_argument) + '\n' +
         roff::filled(x.meaning + (notes.empty() ? "" : " (" + notes + ")"));
}

std::string rows(const command_description& x) {
  std::string out;
  for (const auto& each : x.arguments)
    out += row(each, true);
  for (const auto& each : x.options)
    out += row(each, false);
  return out;
}

std::string synopsis(const command_description& x) {
  std::string out = roff::bold("rubicon" + (x.words.empty() ? "" : ' ' + x.name()));
  if (!x.commands.empty())
    return out + ' ' + roff::italic("COMMAND") + " ...\n";
  out += " [" + roff::italic("options") + ']';
  for (const auto& each : x.arguments) {
    const auto name = roff::italic(each.names.front()) + (each.is_repeatable ? " ..." : "");
    out += each.is_required ? ' ' + name : " [" + name + ']';
  }
  return out + '\n';
}

std::string footer(const command_description& x) {
  return x.footer.empty() ? std::string() : ".PP\n" + roff::paragraphs(x.footer);
}

std::string see_also(std::string_view others) {
  return section("SEE ALSO") + std::string(others);
}

/// A command that has others, `tuples`: each is a part of its page.
std::string parts_of(const command_description& x) {
  std::string out = section("COMMANDS");
  for (const auto& each : x.commands)
    out += ".SS " + roff::quoted("rubicon " + each.name()) + '\n' +
           roff::filled(each.sentence + '.') + ".PP\n" + synopsis(each) + rows(each) + footer(each);
  return out;
}

std::string page_of(const command_description& x, const manual_edition& edition) {
  auto out = head("rubicon-" + x.name('-'), "1", x.sentence, edition);
  out += section("SYNOPSIS") + synopsis(x);
  out += section("DESCRIPTION") + roff::filled(x.sentence + '.') + footer(x);
  if (x.commands.empty())
    out += section("OPTIONS") + rows(x);
  else
    out += parts_of(x);
  return out + see_also(".BR rubicon (1),\n.BR rubicon.toml (5)\n");
}

std::string overview(const command_description& x, const manual_edition& edition) {
  auto out = head("rubicon", "1", "run robotic ecologies", edition);
  out += section("SYNOPSIS") + synopsis(x);
  out += section("DESCRIPTION") + roff::filled(x.sentence) + footer(x);
  out += section("COMMANDS");
  for (const auto& each : x.commands)
    out += ".TP\n.BR " + roff::escaped("rubicon-" + each.name('-')) + " (1)\n" +
           roff::filled(each.sentence + '.');
  return out + section("OPTIONS") + rows(x) + see_also(".BR rubicon.toml (5)\n");
}

std::string key_row(const config::key_description& x) {
  const auto range = range_text(x);
  const auto standard = default_text(x);
  auto notes = range + (range.empty() || standard.empty() ? "" : "; ") + standard;
  const auto meaning = plain_text(x.meaning);
  if (!notes.empty() && !meaning.empty())
    notes = " (" + notes + ')';
  return ".TP\n" + roff::bold(x.name) + '\n' +
         (meaning.empty() && notes.empty() ? ".br\n" : roff::filled(meaning + notes));
}

std::string kinds_section() {
  auto out = section("VALUES");
  for (const auto& each : kinds_with_units())
    out += ".TP\n" + roff::bold(each.name) + '\n' +
           roff::filled(std::string(each.sample) +
                        (each.units.empty() ? "" : "; units: " + std::string(each.units)));
  return out;
}

std::string file_page(const config::table_description& file, const manual_edition& edition) {
  auto out = head("rubicon.toml", "5", "description of a robotic ecology", edition);
  out += section("DESCRIPTION");
  out +=
      roff::filled("A file in TOML describes an ecology: its islands of motes, the PEIS peers, the "
                   "proxies, and what goes wrong on purpose. rubicon new writes one to begin with, "
                   "rubicon check FILE reports all mistakes in one, and rubicon check --explain "
                   "KEY explains a key.");
  out += kinds_section();
  out += section("TABLES AND KEYS");
  for (const auto& title : config::titles_of(file)) {
    const auto keys = config::keys_of(file, title);
    if (keys.empty())
      continue;
    out += ".SS " + roff::quoted(plain_text(title)) + '\n';
    for (const auto* key : keys)
      out += key_row(*key);
  }
  return out + see_also(".BR rubicon (1),\n.BR rubicon-new (1),\n.BR rubicon-check (1)\n");
}

} // namespace

std::vector<manual_page> manual_pages(const command_description& all,
                                      const config::table_description& file,
                                      const manual_edition& edition) {
  std::vector<manual_page> out{{"rubicon.1", overview(all, edition)}};
  for (const auto& each : all.commands)
    out.push_back({"rubicon-" + each.name('-') + ".1", page_of(each, edition)});
  out.push_back({"rubicon.toml.5", file_page(file, edition)});
  return out;
}

} // namespace rubicon::cli
