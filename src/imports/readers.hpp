// For files of this room only: a reader of each format, and what they share.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "imports/plan.hpp"

namespace rubicon::imports {

[[nodiscard]] import_result read_cooja(std::string_view text);
[[nodiscard]] import_result read_setdest(std::string_view text);
[[nodiscard]] import_result read_otns(std::string_view text);
[[nodiscard]] import_result read_iotlab(std::string_view text);
[[nodiscard]] import_result read_tossim(std::string_view text);
[[nodiscard]] import_result read_zep(std::string_view text);
[[nodiscard]] import_result read_k7(std::string_view text);

/// A mistake, on its way out of a reader of this room; import_text() catches it.
struct mistake {
  import_problem why;
};

[[noreturn]] void refuse(text_place at, std::string message);

/// A text within a message: in quotes, cut to 40 octets, others than printable ASCII as `?`.
[[nodiscard]] std::string quoted(std::string_view x);

/// Where the octet at an offset is.
[[nodiscard]] text_place place_of(std::string_view text, std::size_t offset);

/// The same for many offsets of one text: none of them makes it count the lines again.
class place_finder {
public:
  explicit place_finder(std::string_view text);

  [[nodiscard]] text_place at(std::size_t offset) const;

private:
  /// The line that the first octet of a block is in, and where that begins.
  struct block {
    std::size_t line = 1;
    std::size_t line_begin = 0;
  };

  std::string_view text_;
  std::vector<block> blocks_;
};

/// A part of a line, and where it begins.
struct field {
  std::string_view text;
  text_place at;
};

/// The fields of a text, line by line.
class line_fields {
public:
  /// @param separators characters between fields, several of which count as one; empty: a comma,
  /// and each counts
  line_fields(std::string_view text, std::string_view separators)
      : rest_(text), separators_(separators) {}

  /// @returns whether there was another line; it may have no fields
  [[nodiscard]] bool next();

  [[nodiscard]] const std::vector<field>& fields() const { return fields_; }
  [[nodiscard]] std::string_view line() const { return line_; } ///< without its end
  [[nodiscard]] std::size_t number() const { return number_; }
  [[nodiscard]] text_place end() const { return {number_, line_.size() + 1}; }

private:
  void split();
  void split_at_commas();

  std::string_view rest_;
  std::string_view separators_;
  std::string_view line_;
  std::size_t number_ = 0;
  std::vector<field> fields_;
};

/// The whole text is a finite number, without blanks.
[[nodiscard]] std::optional<std::uint64_t> whole_in(std::string_view x);

/// Such a number within limits; refuses all others. @param what it is: `x`
[[nodiscard]] double real_of(const field& x, std::string_view what, double least, double most);
[[nodiscard]] double coordinate_of(const field& x, std::string_view what);
[[nodiscard]] std::uint32_t node_of(const field& x);

/// What is not taken, each kind once.
class note_list {
public:
  void add(text_place at, const std::string& what);
  [[nodiscard]] std::vector<left_out> sorted() const;

private:
  std::map<std::string, text_place> first_;
  bool is_full_ = false;
};

/// Motes by what the file calls them.
class mote_list {
public:
  /// The mote of this number; made if there is none.
  std::size_t by_number(std::uint32_t number, text_place at);
  /// The mote of this name; made if there is none, with the next number.
  std::size_t by_name(std::string_view name, text_place at);

  [[nodiscard]] bool has_number(std::uint32_t x) const { return numbers_.contains(x); }
  [[nodiscard]] bool has_name(std::string_view x) const { return names_.find(x) != names_.end(); }

  [[nodiscard]] planned_mote& at(std::size_t i) { return all_[i]; }
  [[nodiscard]] std::size_t size() const { return all_.size(); }

  /// All, ascending by number, and links with their new indices. Refuses an empty list.
  void give(ecology_plan& to);

private:
  std::vector<planned_mote> all_;
  std::map<std::uint32_t, std::size_t> numbers_;
  std::map<std::string, std::size_t, std::less<>> names_;
};

/// What a reader has found, with its motes and notes in place. Refuses an empty list of motes.
[[nodiscard]] imported finished(imported x, mote_list& motes, const note_list& notes);

} // namespace rubicon::imports
