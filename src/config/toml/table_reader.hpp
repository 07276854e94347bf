// Reads one table of the file: each key is asked for once, and whatever was not asked for is
// unknown.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "config/reading.hpp"
#include "config/toml/document.hpp"
#include "config/toml/problem.hpp"
#include "config/toml/schema.hpp"
#include "config/toml/values.hpp"

namespace rubicon::config {

class table_reader {
public:
  /// @pre `table` holds a table; it and `shared` outlive this
  /// @param title how complaints call the table: `[radio]`
  table_reader(const node& table, std::string title, reading& shared)
      : table_(table), title_(std::move(title)), shared_(shared),
        problems_before_(shared.problems.size()) {
    own_.title = title_;
  }
  table_reader(const table_reader&) = delete;
  table_reader& operator=(const table_reader&) = delete;

  /// What the table at `key` may be instead, and is read elsewhere.
  template <class Kind>
  void instead_of_table(std::string_view key, const Kind& kind) {
    for (auto& each : own_.keys)
      if (each.name == key) {
        each.schema = form_of(kind).schema;
        each.wanted = form_of(kind).wanted + ", or " + wanted_of(each);
      }
  }

  /// All keys that are listed beside a struct. There is no other way to read a value.
  template <class Struct>
  void all(Struct& out) {
    all(out, keys_of(static_cast<const Struct*>(nullptr)));
  }
  template <class Struct, class... Keys>
  void all(Struct& out, const std::tuple<Keys...>& those) {
    std::apply([&](const auto&... each) { (one(each, out), ...); }, those);
  }

  using part_reader = std::function<void(table_reader&)>;

  /// Reads the table at `key`, if there is one.
  bool table(std::string_view key, const std::string& title, const about& what,
             const part_reader& read);

  /// Reads each table of the array at `key`; `title` is `[[island]]`, or a word for inline tables.
  void tables(std::string_view key, const std::string& title, const about& what,
              const part_reader& read, std::size_t at_least = 0);

  /// Describes the tables of other names that there may be, like those of that title. @pre one is
  /// described
  void other_tables(const std::string& title, const about& what);

  /// Reads each table in the table at `key`; the keys in between are names of the author's choice.
  void named_tables(std::string_view key, const std::string& title, const about& what,
                    const std::function<void(const located<std::string>&, table_reader&)>& read);

  /// A key that decides what other keys there are. From here on the table is called by both, as in
  /// `app = "sampler"`; after `within`, if that key has such a value in another table too.
  void one_of(std::string_view key, const about& what,
              const std::vector<std::pair<std::string_view, part_reader>>& choices,
              std::string_view within = {}, bool is_required = true);

  /// Reads one of some structs, that of whose keys the table has the first one, or else the first
  /// struct, and gives it to `use`. Keys that only others have mean nothing with it.
  template <class Use, class... Lists>
  void either(const Use& use, const Lists&... lists) {
    const auto one = [this, &use](const auto& list) {
      decltype(struct_of(list)) x;
      this->all(x, list);
      use(std::move(x));
    };
    if constexpr (sizeof...(lists) == 1)
      (one(lists), ...);
    else
      either({{names_of(lists), [&](table_reader& /*self*/) { one(lists); }}...});
  }

  /// Reports keys that were not asked for as unknown. Called once, where the reader was made.
  void finish() const;

  /// Whether `key` is in the file.
  [[nodiscard]] bool has(std::string_view key) const { return table_.find(key) != nullptr; }

  /// Whether `key` is in the file, was read, and its value is good.
  [[nodiscard]] bool is_good(std::string_view key) const {
    return std::find(good_.begin(), good_.end(), key) != good_.end();
  }

  /// Whether nothing is read and only the keys are wanted.
  [[nodiscard]] bool walks() const { return shared_.walks; }

  /// What the walk has found; its title and keys.
  [[nodiscard]] const table_description& found() const { return own_; }

  [[nodiscard]] const node& content() const { return table_; }
  [[nodiscard]] const std::string& title() const { return title_; }

  /// The place of the value of `key`; of the table if it has none.
  [[nodiscard]] mark at(std::string_view key) const;
  [[nodiscard]] mark at() const { return table_.at; }

  /// Takes `key` for known without reading it.
  void expect(std::string_view key) { static_cast<void>(ask(key)); }

  /// Whether all that was read so far is good: a check across keys would judge defaults otherwise.
  [[nodiscard]] bool sound() const { return shared_.problems.size() == problems_before_; }

  [[nodiscard]] complaints& problems() const { return shared_.problems; }
  [[nodiscard]] reading& shared() const { return shared_; }

private:
  /// Reads `key` into `out`; complains if it is missing or not of that kind.
  /// @returns whether `out` was set
  template <class Kind, class Out>
  bool required(std::string_view key, const Kind& kind, Out& out, const about& what) {
    describe({.is_required = true}, key, kind, what);
    return get(true, key, kind, out);
  }

  /// The same, but a missing key leaves `out` as it is.
  template <class Kind, class Out>
  bool optional(std::string_view key, const Kind& kind, Out& out, const about& what) {
    describe({.standard = written_of(kind, out)}, key, kind, what);
    return get(false, key, kind, out);
  }

  /// One that is required under a condition only.
  template <class Kind, class Out>
  bool required_if(bool condition, std::string_view key, const Kind& kind, Out& out,
                   const about& what) {
    describe({}, key, kind, what);
    return get(condition && !walks(), key, kind, out);
  }

  /// The names of keys, and what reads all of them.
  using alternative = std::pair<std::vector<std::string_view>, part_reader>;
  void either(const std::vector<alternative>& choices);

  template <class Struct, class Member, class Kind, class... Keys>
  static Struct struct_of(const std::tuple<keys::key<Struct, Member, Kind>, Keys...>& list);

  template <class... Keys>
  [[nodiscard]] static std::vector<std::string_view> names_of(const std::tuple<Keys...>& list) {
    return std::apply([](const auto&... each) { return std::vector{each.name...}; }, list);
  }

  [[nodiscard]] const node* ask(std::string_view key);
  void complain(mark at, std::string message) const {
    shared_.problems.add(at, std::move(message));
  }
  void lacks(std::string_view key) const;
  void read_part(const node& x, const std::string& title, const part_reader& read) const;

  /// Describes the key of a part, by a walk through it.
  void walk(std::string_view key, part kind, const std::string& title, const about& what,
            const part_reader& read, bool is_required = false);
  void add(key_description x);

  template <class Kind>
  void describe(key_description x, std::string_view key, const Kind& kind, const about& what) {
    if (!walks())
      return;
    auto [wanted, schema] = form_of(kind);
    x.name = key;
    x.is_required = x.is_required && !in_choice_;
    x.meaning = what.meaning;
    x.wanted = what.wanted.empty() ? std::move(wanted) : std::string(what.wanted);
    x.unset = what.unset;
    x.is_changeable = what.is_changeable;
    x.is_removable = what.is_removable;
    x.effect = what.effect;
    x.schema = std::move(schema);
    add(std::move(x));
  }

  /// What a file would write for a default; empty if it cannot.
  template <class Kind, class Out>
  [[nodiscard]] json_text written_of(const Kind& kind, const Out& x) const {
    if constexpr (requires { x.has_value(); })
      return x.has_value() ? written_of(kind, *x) : json_text();
    else if constexpr (requires { written(kind, x); })
      return walks() ? written(kind, x) : json_text();
    else if constexpr (requires { written(kind, x.value); })
      return walks() ? written(kind, x.value) : json_text();
    else
      return {};
  }

  template <class Struct, class Member, class Kind>
  void one(const keys::key<Struct, Member, Kind>& key, Struct& out) {
    if (key.is_conditional)
      required_if(key.is_required, key.name, key.kind, out.*key.member, key.what);
    else if (key.is_required)
      required(key.name, key.kind, out.*key.member, key.what);
    else
      optional(key.name, key.kind, out.*key.member, key.what);
  }

  template <class Kind, class Out>
  bool get(bool is_required, std::string_view key, const Kind& kind, Out& out) {
    const auto* x = ask(key);
    if (x == nullptr && is_required)
      lacks(key);
    if (x == nullptr)
      return false;
    auto value = read(kind, *x, asker{key, shared_});
    if (!value)
      return false;
    set(out, *std::move(value));
    good_.emplace_back(key);
    return true;
  }

  template <class Out, class Value>
  static void set(Out& out, Value value) {
    out = Out(std::move(value));
  }
  template <class T>
  static void set(std::vector<located<T>>& out, std::vector<located<T>> value) {
    out = std::move(value);
  }
  template <class Out, class T>
  static void set(std::vector<Out>& out, std::vector<located<T>> value) {
    out.clear();
    for (auto& each : value)
      out.push_back(Out(std::move(each.value)));
  }

  const node& table_;
  std::string title_;
  table_description own_;
  table_description* described_ = &own_; ///< own_, or one of its variants
  reading& shared_;
  std::size_t problems_before_ = 0;
  std::vector<std::string> asked_;
  std::vector<std::string> good_; ///< those whose values were read
  bool in_choice_ = false;        ///< what is read is one of several possibilities
  bool silent_ = false;           ///< what the table is could not be read, so its keys mean nothing
};

} // namespace rubicon::config
