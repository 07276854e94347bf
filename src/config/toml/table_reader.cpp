#include "config/toml/table_reader.hpp"

#include <algorithm>

#include "config/toml/schema.hpp"
#include "core/text/spelling.hpp"

namespace rubicon::config {

namespace {

/// Ends a complaint about a key that its table does not have: the key that was meant, or the tables
/// that have it, or else what keys there are.
std::string cure_for(const std::string& key, const std::string& title,
                     const std::vector<std::string>& known) {
  constexpr std::size_t named_max = 3;
  if (!nearest(key, known).empty())
    return suggestion(key, known);
  static const auto file = describe_file();
  const auto titles = titles_with(file, key);
  if (titles.empty() || std::ranges::find(titles, title) != titles.end()) // of another variant
    return suggestion(key, known);
  std::string text = ": it is a key of ";
  for (std::size_t i = 0; i < titles.size() && i < named_max; ++i)
    text += (i == 0 ? "" : ", ") + titles[i];
  return text + (titles.size() > named_max ? ", ..." : "") + "; see rubicon check --explain " + key;
}

} // namespace

const node* table_reader::ask(std::string_view key) {
  if (std::find(asked_.begin(), asked_.end(), key) == asked_.end())
    asked_.emplace_back(key);
  return table_.find(key);
}

void table_reader::add(key_description x) {
  if (described_->find(x.name) == nullptr)
    described_->keys.push_back(std::move(x));
}

void table_reader::walk(std::string_view key, part kind, const std::string& title,
                        const about& what, const part_reader& read, bool is_required) {
  table_reader part(no_keys, title, shared_);
  read(part);
  add({.name = std::string(key),
       .meaning = std::string(what.meaning),
       .wanted = std::string(what.wanted),
       .unset = std::string(what.unset),
       .is_required = is_required,
       .is_changeable = what.is_changeable,
       .is_removable = what.is_removable,
       .effect = std::string(what.effect),
       .part = kind,
       .table = std::make_shared<const table_description>(std::move(part.own_))});
}

void table_reader::lacks(std::string_view key) const {
  if (!silent_)
    complain(table_.at, '`' + std::string(key) + "` is missing in " + title_);
}

mark table_reader::at(std::string_view key) const {
  const auto* x = table_.find(key);
  return x == nullptr ? table_.at : x->at;
}

void table_reader::read_part(const node& x, const std::string& title,
                             const part_reader& read) const {
  table_reader part(x, title, shared_);
  read(part);
  part.finish();
}

bool table_reader::table(std::string_view key, const std::string& title, const about& what,
                         const part_reader& read) {
  if (walks())
    walk(key, part::table, title, what, read);
  const auto* x = ask(key);
  if (x == nullptr)
    return walks();
  if (x->as<node_table>() == nullptr) {
    const bool has_header = x->as<node_array>() != nullptr && title.starts_with('[');
    asker{key, shared_}.refuse(*x, "a table", has_header ? "; its header is " + title : "");
    return false;
  }
  read_part(*x, title, read);
  return true;
}

void table_reader::other_tables(const std::string& title, const about& what) {
  if (!walks())
    return;
  const auto like = std::ranges::find_if(
      own_.keys, [&title](const auto& x) { return x.table && x.table->title == title; });
  add({.name = "NAME",
       .meaning = std::string(what.meaning),
       .part = part::other_tables,
       .table = like->table});
}

void table_reader::tables(std::string_view key, const std::string& title, const about& what,
                          const part_reader& read, std::size_t at_least) {
  if (walks())
    walk(key, part::tables, title, what, read, at_least > 0);
  const auto* x = ask(key);
  if (x == nullptr) {
    if (at_least > 0)
      lacks(key);
    return;
  }
  const asker who{key, shared_};
  const auto wanted = title.starts_with("[[") ? "tables under headers " + title
                                              : "an array of tables, as in [{ ... }]";
  const auto* elements = x->as<node_array>();
  if (elements == nullptr) {
    who.refuse(*x, wanted);
    return;
  }
  if (elements->size() < at_least)
    who.refuse(*x, "an array of at least " + std::to_string(at_least));
  for (const auto& element : *elements) {
    if (element.as<node_table>() == nullptr)
      who.refuse(element, wanted);
    else
      read_part(element, title, read);
  }
}

void table_reader::named_tables(
    std::string_view key, const std::string& title, const about& what,
    const std::function<void(const located<std::string>&, table_reader&)>& read) {
  if (walks())
    walk(key, part::named_tables, title, what, [&](table_reader& part) {
      read({"NAME", {}}, part);
    });
  const auto* x = ask(key);
  if (x == nullptr)
    return;
  const auto wanted = "tables under headers " + title;
  const auto* members = x->as<node_table>();
  if (members == nullptr) {
    asker{key, shared_}.refuse(*x, wanted);
    return;
  }
  for (const auto& each : *members) {
    if (each.value.as<node_table>() == nullptr)
      asker{each.key, shared_}.refuse(each.value, wanted);
    else
      read_part(each.value, title, [&](table_reader& part) { read({each.key, each.at}, part); });
  }
}

void table_reader::one_of(std::string_view key, const about& what,
                          const std::vector<std::pair<std::string_view, part_reader>>& choices,
                          std::string_view within, bool is_required) {
  word<std::size_t> words;
  for (std::size_t i = 0; i < choices.size(); ++i)
    words.choices.emplace_back(choices[i].first, i);
  const auto title_of = [&](std::string_view choice) {
    return std::string(within) + (within.empty() ? "" : " ") + std::string(key) + " = \"" +
           std::string(choice) + '"';
  };
  if (walks()) {
    describe({.is_required = is_required}, key, words, what);
    own_.choice = key;
    for (const auto& [choice, read] : choices) {
      table_description variant{
          .title = title_of(choice), .keys = {}, .choice = {}, .variants = {}};
      described_ = &variant;
      read(*this);
      own_.variants.push_back(std::move(variant));
    }
    described_ = &own_;
    return;
  }
  std::size_t chosen = 0;
  if (get(true, key, words, chosen)) {
    title_ = title_of(choices[chosen].first);
    choices[chosen].second(*this);
  } else {
    silent_ = true;
  }
}

void table_reader::either(const std::vector<alternative>& choices) {
  if (walks()) {
    in_choice_ = true;
    for (const auto& each : choices)
      each.second(*this);
    in_choice_ = false;
    return;
  }
  const auto found =
      std::ranges::find_if(choices, [this](const auto& x) { return has(x.first.front()); });
  const auto& chosen = found == choices.end() ? choices.front() : *found;
  chosen.second(*this);
  for (const auto& [keys, read] : choices)
    for (const auto key : keys) {
      if (std::ranges::find(asked_, key) == asked_.end() && has(key))
        complain(at(key), '`' + std::string(key) + "` has no effect with `" +
                              std::string(chosen.first.front()) + '`');
      expect(key);
    }
}

void table_reader::finish() const {
  const auto* members = table_.as<node_table>();
  if (silent_ || members == nullptr)
    return;
  for (const auto& each : *members) {
    if (std::find(asked_.begin(), asked_.end(), each.key) == asked_.end())
      complain(each.at,
               "unknown key `" + each.key + "` in " + title_ + cure_for(each.key, title_, asked_));
  }
}

} // namespace rubicon::config
