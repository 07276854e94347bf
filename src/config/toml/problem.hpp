// What is wrong with a file, and where.
#pragma once

#include <compare>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rubicon::config {

/// One mistake. Lines and columns count from 1, columns in characters; line 0: the file as a whole;
/// column 0: the line as a whole.
struct problem {
  std::string file;
  unsigned line = 0;
  unsigned column = 0;
  std::string message;

  friend bool operator==(const problem&, const problem&) = default;
};

/// `file:line:column: message`, `file:line: message` or `file: message`; printable().
[[nodiscard]] std::string to_string(const problem& x);

/// A place in the file that is read, or one of the settings of the command line.
struct mark {
  unsigned line = 0;
  unsigned column = 0;

  friend auto operator<=>(const mark&, const mark&) = default;
};

/// The place of what a setting has written, counted from 0: behind all lines that a file can have.
[[nodiscard]] mark mark_of_setting(std::size_t index);

/// Which setting that is; nothing for a place in the file.
[[nodiscard]] std::optional<std::size_t> setting_of(mark x);

/// A value and its place.
template <class T>
struct located {
  T value{};
  mark at;
};

/// `(line 3, column 7)` or `(--set)`
[[nodiscard]] std::string place_text(mark x);

/// Gathers the problems of one file, and of the files that it names.
class complaints {
public:
  /// `message` is made printable(): it may quote the file and goes to a terminal.
  void add(mark at, std::string message);

  /// A problem of another file, or of this one as a whole.
  void add(problem x);

  /// What does no harm to the rest: it is left out.
  void skip(problem x);
  [[nodiscard]] const std::vector<problem>& skipped() const { return skipped_; }

  /// What is no mistake, but hardly what is meant.
  void warn(mark at, std::string message);
  [[nodiscard]] std::vector<problem> warnings_of(const std::string& name) const; ///< as of_file()

  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] std::size_t size() const { return found_.size() + elsewhere_.size(); }

  /// In order of place, each once: a mistake in a mote type is found again with each of its motes.
  /// Those with a file of their own come last.
  [[nodiscard]] std::vector<problem> of_file(const std::string& name) const;

private:
  std::vector<std::pair<mark, std::string>> found_;
  std::vector<problem> elsewhere_;
  std::vector<problem> skipped_;
  std::vector<std::pair<mark, std::string>> warnings_;
};

} // namespace rubicon::config
