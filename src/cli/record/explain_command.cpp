#include "cli/record/explain_command.hpp"

#include <cerrno>
#include <fstream>
#include <string_view>
#include <system_error>
#include <variant>

#include "cli/print/console.hpp"
#include "cli/record/read_record.hpp"
#include "core/text/printable.hpp"
#include "core/text/spelling.hpp"
#include "exports/mcap_file.hpp"
#include "exports/trace_events.hpp"

namespace rubicon::cli {

namespace {

exit_status not_found(const std::string& text) {
  say(text);
  return exit_status::refused;
}

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words)
    text += (text.empty() ? "" : " or ") + word;
  return text;
}

struct answerer {
  const explain_command& asked;
  const explain::traces& all;
  explain::text_style style;

  exit_status operator()(const explain::nothing_found& x) const {
    if (x.is_ambiguous)
      return not_found(asked.record + ": several peers have `" + asked.what + "`: say " +
                       listed(x.known));
    const bool is_message = asked.what.find_first_of("#/") != std::string::npos;
    return not_found(asked.record + ": no " + (is_message ? "message" : "tuple") + " `" +
                     asked.what + '`' + suggestion(asked.what, x.known));
  }

  exit_status operator()(const explain::message_found& x) const {
    return say(asked.json ? message_json(all, x.index) : message_text(all, x.index, style));
  }

  exit_status operator()(const explain::tuples_found& x) const {
    if (asked.all)
      return say(asked.json ? values_json(all, x.indices, asked.list.limit)
                            : values_text(all, x.indices, asked.list.limit, style));
    auto index = x.indices.back();
    if (asked.at) {
      const auto then = value_at(all, x.indices, instant(*asked.at));
      if (!then)
        return not_found(asked.record + ": `" + asked.what + "` had no value yet at that time");
      index = *then;
    }
    return say(asked.json ? tuple_json(all, index) : tuple_text(all, index, style));
  }

  static exit_status say(const std::string& text) {
    return print(stdout, text) ? exit_status::good : exit_status::refused;
  }
};

/// @param write_to of the room `exports`
/// @returns why not all of it is written; empty: it is, or there is no file
std::string exported(const std::string& path, const explain::traces& all,
                     void (*write_to)(const explain::traces&, const exports::octets_out&)) {
  if (path.empty())
    return {};
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (file)
    write_to(all, [&file](std::string_view octets) {
      file.write(octets.data(), static_cast<std::streamsize>(octets.size()));
    });
  file.close();
  return file ? std::string()
              : path + ": cannot be written: " +
                    std::generic_category().message(errno != 0 ? errno : EIO);
}

} // namespace

exit_status perform(const explain_command& x) {
  const auto found = read_record(x.record);
  if (const auto* why = std::get_if<std::string>(&found))
    return not_found(*why);
  const auto& all = std::get<explain::traces>(found);
  if (!x.trace_events.empty() || !x.mcap.empty()) {
    auto why = exported(x.trace_events, all, exports::write_trace_events);
    if (why.empty())
      why = exported(x.mcap, all, exports::write_mcap);
    return why.empty() ? exit_status::good : not_found(why);
  }
  const auto output = console_of(stdout);
  const explain::text_style style{output.width, output.colour, output.room()};
  if (!x.what.empty())
    return std::visit(answerer{x, all, style}, explain::find(all, x.what));
  return answerer::say(x.json ? list_json(all, x.list) : list_text(all, x.list, style));
}

} // namespace rubicon::cli
