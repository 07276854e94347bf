// All that a file may say, as the readers describe it while they walk through every table they
// might meet.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "config/toml/form.hpp"

namespace rubicon::config {

struct table_description;

/// What stands behind a key.
/// other_tables: those of all other keys, too.
enum class part : std::uint8_t { value, table, tables, named_tables, other_tables };

struct key_description {
  std::string name{};
  std::string meaning{}; ///< one sentence in Markdown
  std::string wanted{};  ///< what it may be, in Markdown
  std::string unset{};   ///< what holds without it, in words; empty: `standard` does
  json_text standard{};  ///< default as a file would write it
  json_text schema{};    ///< JSON Schema of a value
  bool is_required = false;
  bool is_changeable = false; ///< while an ecology runs
  bool is_removable = true;   ///< the same
  std::string effect{};       ///< of a change, if that is not obvious
  config::part part = config::part::value;
  std::shared_ptr<const table_description> table{}; ///< of a part that is no value
};

struct table_description {
  std::string title; ///< `[radio]`, as complaints and documents call it
  std::vector<key_description> keys;
  std::string choice; ///< the key that decides what others there are; empty: none
  std::vector<table_description> variants; ///< in the order of its words, with their keys only

  [[nodiscard]] const key_description* find(std::string_view key) const;

  /// That of a table with this word at `choice`; nullptr if there is none.
  [[nodiscard]] const table_description* variant(std::string_view word) const;
};

/// All that a file may say.
[[nodiscard]] table_description describe_file();

/// What a key may be, in Markdown; of a table a link to what is said of it.
[[nodiscard]] std::string wanted_of(const key_description& x);

/// Whether a key may change while an ecology runs, `yes`, and what that affects; else empty.
[[nodiscard]] std::string change_of(const key_description& x);

/// JSON Schema (draft 7) of a file, for editors and validators.
[[nodiscard]] std::string json_schema(const table_description& file);

/// The keys of all tables of that title together, each once, without the one that chooses between
/// variants. @pre `file` lives longer
[[nodiscard]] std::vector<const key_description*> keys_of(const table_description& file,
                                                          std::string_view title);

/// The rows of docs/configuration.md about the tables of that title: a Markdown table; empty if
/// there is no such title or it has no keys.
[[nodiscard]] std::string markdown_of(const table_description& file, std::string_view title);

/// A text in which the lines between `<!-- keys of TITLE -->` and `<!-- end of keys -->` are
/// replaced by such tables.
[[nodiscard]] std::string with_tables(const table_description& file, const std::string& text);

/// Titles of all tables that have a key of this name, each once, in the order of the file.
[[nodiscard]] std::vector<std::string> titles_with(const table_description& file,
                                                   std::string_view key);

/// Titles of all tables that have keys, each once, in the order of the file.
[[nodiscard]] std::vector<std::string> titles_of(const table_description& file);

} // namespace rubicon::config
