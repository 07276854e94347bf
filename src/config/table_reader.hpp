// Reads one table of the file: each key is asked for once, and whatever was not asked for is
// unknown.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/document.hpp"
#include "config/problem.hpp"
#include "config/values.hpp"

namespace rubicon::config {

/// A table as documentation and complaints call it, `[radio]`, and one of its keys.
using accepted_key = std::pair<std::string, std::string>;

class trace_files;
struct named_files;

/// What the readers of one file share.
struct reading {
  complaints problems;
  /// Set: nothing is read; every reader walks through all the tables it might meet, and the keys it
  /// would ask for are collected here.
  std::set<accepted_key>* accepted = nullptr;
  trace_files* traces = nullptr;      ///< set unless `accepted` is
  const named_files* files = nullptr; ///< the same
};

class table_reader {
public:
  /// @pre `table` holds a table; it and `shared` outlive this
  /// @param title how complaints call the table: `[radio]`
  table_reader(const node& table, std::string title, reading& shared)
      : table_(table), title_(std::move(title)), shared_(shared),
        problems_before_(shared.problems.size()) {}

  /// Reads `key` into `out`; complains if it is missing or not of that kind.
  /// @returns whether `out` was set
  template <class Kind, class Out>
  bool required(std::string_view key, const Kind& kind, Out& out) {
    const auto* x = ask(key);
    if (x == nullptr)
      lacks(key);
    return x != nullptr && take(key, *x, kind, out);
  }

  /// The same, but a missing key leaves `out` as it is.
  template <class Kind, class Out>
  bool optional(std::string_view key, const Kind& kind, Out& out) {
    const auto* x = ask(key);
    return x != nullptr && take(key, *x, kind, out);
  }

  using part_reader = std::function<void(table_reader&)>;

  /// Reads the table at `key`, if there is one.
  bool table(std::string_view key, const std::string& title, const part_reader& read);

  /// Reads each table of the array at `key`; `title` is `[[island]]`, or a word for inline tables.
  void tables(std::string_view key, const std::string& title, const part_reader& read,
              std::size_t at_least = 0);

  /// Reads each table in the table at `key`; the keys in between are names of the author's choice.
  void named_tables(std::string_view key, const std::string& title,
                    const std::function<void(const located<std::string>&, table_reader&)>& read);

  /// A key that decides what other keys there are. From here on the table is called by both, as in
  /// `app = "sampler"`; after `within`, if that key has such a value in another table too.
  void one_of(std::string_view key,
              const std::vector<std::pair<std::string_view, part_reader>>& choices,
              std::string_view within = {});

  /// Complains about keys nobody asked for. Called once, by who made this reader.
  void finish() const;

  /// Whether `key` is in the file.
  [[nodiscard]] bool has(std::string_view key) const { return table_.find(key) != nullptr; }

  /// Whether nothing is read and only the keys are wanted.
  [[nodiscard]] bool walks() const { return shared_.accepted != nullptr; }

  [[nodiscard]] const std::string& title() const { return title_; }

  /// The place of the value of `key`; of the table if it has none.
  [[nodiscard]] mark at(std::string_view key) const;
  [[nodiscard]] mark at() const { return table_.at; }

  /// The value of `key`; nullptr if it has none.
  [[nodiscard]] const node* value(std::string_view key) const { return table_.find(key); }

  /// Takes `key` for known without reading it.
  void expect(std::string_view key) { static_cast<void>(ask(key)); }

  /// Whether all that was read so far is good: a check across keys would judge defaults otherwise.
  [[nodiscard]] bool sound() const { return shared_.problems.size() == problems_before_; }

  [[nodiscard]] complaints& problems() const { return shared_.problems; }
  [[nodiscard]] reading& shared() const { return shared_; }

private:
  [[nodiscard]] const node* ask(std::string_view key);
  void complain(mark at, std::string message) const {
    shared_.problems.add(at, std::move(message));
  }
  void lacks(std::string_view key) const;
  void read_part(const node& x, const std::string& title, const part_reader& read) const;

  template <class Kind, class Out>
  bool take(std::string_view key, const node& x, const Kind& kind, Out& out) {
    auto value = kind.read(x, asker{key, shared_.problems});
    if (!value)
      return false;
    out = Out(*std::move(value));
    return true;
  }

  const node& table_;
  std::string title_;
  reading& shared_;
  std::size_t problems_before_ = 0;
  std::vector<std::string> asked_;
  bool silent_ = false; ///< what the table is could not be read, so its keys mean nothing
};

} // namespace rubicon::config
