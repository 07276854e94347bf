#include <algorithm>
#include <array>
#include <utility>

#include "core/text/spelling.hpp"
#include "imports/readers.hpp"

namespace rubicon::imports {

namespace {

struct known_format {
  format which;
  std::string_view word;
  import_result (*read)(std::string_view);
};

constexpr std::array all_formats{
    known_format{format::cooja, "cooja", read_cooja},
    known_format{format::setdest, "setdest", read_setdest},
    known_format{format::otns, "otns", read_otns},
    known_format{format::iotlab, "iotlab", read_iotlab},
    known_format{format::tossim, "tossim", read_tossim},
    known_format{format::zep, "zep", read_zep},
    known_format{format::k7, "k7", read_k7},
};

bool has_word(std::string_view text, std::string_view word) {
  constexpr std::size_t head_octets = 4096;
  return text.substr(0, head_octets).find(word) != std::string_view::npos;
}

std::size_t count_of_first_line(std::string_view text) {
  line_fields lines(text, " \t");
  while (lines.next())
    if (!lines.fields().empty() && !lines.fields().front().text.starts_with('#'))
      return lines.fields().size();
  return 0;
}

std::vector<std::string> mote_names(const ecology_plan& x) {
  std::vector<std::string> out;
  for (const auto& each : x.motes)
    out.push_back(each.name.empty() ? std::to_string(each.number) : each.name);
  return out;
}

void choose_sink(imported& x, std::string_view wanted) {
  const auto& motes = x.plan.motes;
  auto found =
      std::ranges::find_if(motes, [](const planned_mote& mote) { return mote.path.empty(); });
  if (!wanted.empty()) {
    const auto names = mote_names(x.plan);
    const auto named = std::ranges::find(names, wanted);
    if (named == names.end())
      refuse({}, "there is no mote " + quoted(wanted) + ", which --sink names" +
                     suggestion(wanted, names));
    found = motes.begin() + (named - names.begin());
  }
  x.sink = found == motes.end() ? 0 : static_cast<std::size_t>(found - motes.begin());
  if (!motes[x.sink].path.empty())
    x.notes.insert(x.notes.begin(),
                   {{}, "movements of the sink, which stays where it is at the beginning"});
}

} // namespace

std::string_view to_string(format x) {
  return std::ranges::find(all_formats, x, &known_format::which)->word;
}

std::optional<format> parse_format(std::string_view word) {
  const auto found = std::ranges::find(all_formats, word, &known_format::word);
  return found == all_formats.end() ? std::nullopt : std::optional(found->which);
}

std::optional<format> format_of(std::string_view file_name, std::string_view text) {
  if (file_name.ends_with(".csc") || has_word(text, "<simconf"))
    return format::cooja;
  if (file_name.ends_with(".k7") || file_name.ends_with(".k7.gz") || has_word(text, "\ndatetime,"))
    return format::k7;
  if (file_name.ends_with(".yaml") || file_name.ends_with(".yml"))
    return format::otns;
  if (file_name.ends_with(".json"))
    return format::iotlab;
  if (has_word(text, "$node_("))
    return format::setdest;
  if (has_word(text, "gain") || has_word(text, "noise"))
    return format::tossim;
  const auto count = count_of_first_line(text);
  return count == 3 || count == 4 ? std::optional(format::zep) : std::nullopt;
}

import_result import_text(format from, std::string_view text, std::string_view sink) {
  if (text.size() > file_octets_max)
    return import_problem{{}, "it has more than 64 MiB"};
  if (text.starts_with("\xef\xbb\xbf"))
    text.remove_prefix(3);
  try {
    auto out = std::ranges::find(all_formats, from, &known_format::which)->read(text);
    if (auto* const x = std::get_if<imported>(&out))
      choose_sink(*x, sink);
    return out;
  } catch (mistake& x) {
    return std::move(x.why);
  }
}

} // namespace rubicon::imports
