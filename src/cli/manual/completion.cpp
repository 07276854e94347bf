#include "cli/manual/completion.hpp"

#include <functional>
#include <vector>

#include "core/text/shell_word.hpp"

namespace rubicon::cli {

namespace {

constexpr std::string_view origin = "# Written by `rubicon completion`.\n";

void each_command(const command_description& x,
                  const std::function<void(const command_description&)>& use) {
  use(x);
  for (const auto& each : x.commands)
    each_command(each, use);
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words)
    out += (out.empty() ? "" : " ") + word;
  return out;
}

std::vector<std::string> option_names(const command_description& x) {
  std::vector<std::string> out;
  for (const auto& option : x.options)
    out.insert(out.end(), option.names.begin(), option.names.end());
  return out;
}

std::vector<std::string> command_names(const command_description& x) {
  std::vector<std::string> out;
  for (const auto& each : x.commands)
    out.push_back(each.words.back());
  return out;
}

/// What an argument of a command may be: words, and whether a file or folder.
struct argument_completion {
  std::vector<std::string> words;
  completes with = completes::nothing;
};

argument_completion arguments_of(const command_description& x) {
  argument_completion out{command_names(x)};
  for (const auto& each : x.arguments) {
    out.words.insert(out.words.end(), each.words.begin(), each.words.end());
    if (each.with == completes::files || each.with == completes::folders)
      out.with = each.with;
  }
  return out;
}

// ---------------------------------------------------------------------------------------------
// bash

std::string bash_files(completes with) {
  switch (with) {
  case completes::files:
    return "-f";
  case completes::folders:
    return "-d";
  case completes::nothing:
  case completes::words:
    break;
  }
  return {};
}

/// The command that the words before the cursor make: `tuples set`.
std::string bash_paths(const command_description& all) {
  std::string out;
  each_command(all, [&out](const command_description& x) {
    if (!x.words.empty())
      out += (out.empty() ? "" : " | ") + shell_word(x.name());
  });
  return out;
}

/// `'run --mode' | 'run --mode='`: an optional value stands behind = only.
std::string bash_patterns(const std::string& command, const option_description& x) {
  std::string out;
  for (const auto& name : x.names)
    for (const auto* const end : {"", "="})
      if (!x.has_optional_value || *end != '\0')
        out.append(out.empty() ? "" : " | ").append(shell_word(command + ' ' + name + end));
  return out;
}

std::string bash_values(const command_description& x) {
  std::string out;
  for (const auto& option : x.options) {
    if (option.value.empty())
      continue;
    const auto names = bash_patterns(x.name(), option);
    const auto files = bash_files(option.with);
    const auto what = option.words.empty() ? files : "-W " + shell_word(joined(option.words));
    out +=
        "    " + names + ')' + (what.empty() ? "" : " _rubicon_add " + what + ';') + " return ;;\n";
  }
  return out;
}

std::string bash_words(const command_description& x) {
  const auto arguments = arguments_of(x);
  return "    " + shell_word(x.name()) + ") options=" + shell_word(joined(option_names(x))) +
         " words=" + shell_word(joined(arguments.words)) + " files=" + bash_files(arguments.with) +
         " ;;\n";
}

std::string bash_script(const command_description& all) {
  std::string values;
  std::string words;
  each_command(all, [&](const command_description& x) {
    values += bash_values(x);
    words += bash_words(x);
  });
  return std::string(origin) + R"(_rubicon_add() {
  mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen "$@" -- "$word")
}
_rubicon() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command='' options='' words='' files='' i
  if [[ $word == = ]]; then
    word='' before+==
  elif [[ $before == = ]]; then
    before=${COMP_WORDS[COMP_CWORD-2]}=
  fi
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$command${command:+ }${COMP_WORDS[i]}" in
    )" + bash_paths(all) +
         R"() command+="${command:+ }${COMP_WORDS[i]}" ;;
    esac
  done
  case "$command $before" in
)" + values +
         R"(  esac
  case $command in
)" + words +
         R"(  esac
  if [[ $word == -* ]]; then
    _rubicon_add -W "$options"
    return
  fi
  [[ -z $words ]] || _rubicon_add -W "$words"
  [[ -z $files ]] || _rubicon_add $files
}
complete -o filenames -F _rubicon rubicon
)";
}

// ----------------------------------------------------------------------------------------------
// zsh

/// A text in which `[`, `]` and `:` mean nothing, within single quotes.
std::string zsh_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\')
      out += '\\';
    out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return out;
}

std::string zsh_action(const option_description& x) {
  switch (x.with) {
  case completes::words:
    return '(' + joined(x.words) + ')';
  case completes::files:
    return "_files";
  case completes::folders:
    return "_files -/";
  case completes::nothing:
    break;
  }
  return " ";
}

std::string zsh_option(const option_description& x) {
  std::string out;
  for (const auto& name : x.names) {
    const auto value = x.value.empty() ? std::string()
                                       : (x.has_optional_value ? "::" : ":") + zsh_text(x.value) +
                                             ':' + zsh_action(x);
    const auto equals = x.value.empty() || !name.starts_with("--") ? ""
                        : x.has_optional_value                     ? "=-"
                                                                   : "=";
    out += std::string(" '") + (x.is_repeatable ? "*" : "") + name + equals + '[' +
           zsh_text(x.meaning) + ']' + value + '\'';
  }
  return out;
}

std::string zsh_function(const command_description& x) {
  std::string name = "_rubicon";
  for (const auto& word : x.words)
    name += '_' + word;
  std::string out = name + "() {\n";
  if (!x.commands.empty()) {
    out += "  local state line\n  _arguments -C";
    for (const auto& option : x.options)
      out += zsh_option(option);
    out += " '1: :->command' '*:: :->rest'\n  case $state in\n  command) local -a all=(";
    for (const auto& each : x.commands)
      out += " '" + each.words.back() + ':' + zsh_text(each.sentence) + '\'';
    out += " ); _describe command all ;;\n  rest) case $line[1] in\n";
    for (const auto& each : x.commands)
      out += "    " + each.words.back() + ") " + name + '_' + each.words.back() + " ;;\n";
    return out + "    esac ;;\n  esac\n}\n";
  }
  out += "  _arguments";
  for (const auto& option : x.options)
    out += zsh_option(option);
  for (const auto& argument : x.arguments)
    out += std::string(" '") + (argument.is_repeatable ? "*" : "") +
           (argument.is_required ? ":" : "::") + zsh_text(argument.names.front()) + ':' +
           zsh_action(argument) + '\'';
  return out + "\n}\n";
}

std::string zsh_script(const command_description& all) {
  std::string out = "#compdef rubicon\n" + std::string(origin);
  each_command(all, [&out](const command_description& x) { out += zsh_function(x); });
  return out + "if [[ $funcstack[1] == _rubicon ]]; then\n  _rubicon \"$@\"\nelse\n"
               "  compdef _rubicon rubicon\nfi\n";
}

// ---------------------------------------------------------------------------------------------
// fish

/// When it applies: the command's words are there, and none of a command below it.
std::string fish_condition(const command_description& x) {
  std::string out;
  for (const auto& word : x.words)
    out += (out.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + word);
  if (!x.commands.empty())
    out += (out.empty() ? "" : "; and ") +
           ("not __fish_seen_subcommand_from " + joined(command_names(x)));
  return " -n " + shell_word(out);
}

std::string fish_value(const option_description& x) {
  if (x.value.empty() || x.has_optional_value)
    return x.words.empty() ? std::string() : " -a " + shell_word(joined(x.words));
  switch (x.with) {
  case completes::words:
    return " -x -a " + shell_word(joined(x.words));
  case completes::files:
    return " -r -F";
  case completes::folders:
    return " -x -a '(__fish_complete_directories)'";
  case completes::nothing:
    break;
  }
  return " -x";
}

std::string fish_script(const command_description& all) {
  auto out = std::string(origin) + "complete -c rubicon -f\n";
  each_command(all, [&out](const command_description& x) {
    const auto begin = "complete -c rubicon" + fish_condition(x);
    for (const auto& each : x.commands)
      out += begin + " -a " + each.words.back() + " -d " + shell_word(each.sentence) + '\n';
    for (const auto& each : x.arguments)
      if (each.with == completes::files || each.with == completes::folders)
        out += begin + " -F\n";
      else if (!each.words.empty())
        out += begin + " -a " + shell_word(joined(each.words)) + '\n';
    for (const auto& option : x.options) {
      out += begin;
      for (const auto& name : option.names)
        out += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      out += " -d " + shell_word(option.meaning) + fish_value(option) + '\n';
    }
  });
  return out;
}

} // namespace

std::string completion_script(const command_description& all, std::string_view shell) {
  if (shell == "bash")
    return bash_script(all);
  if (shell == "zsh")
    return zsh_script(all);
  return shell == "fish" ? fish_script(all) : std::string();
}

} // namespace rubicon::cli
