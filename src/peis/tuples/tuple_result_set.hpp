// What reading from the tuple space gives: one tuple, or a set of them (TUP-12, TUP-13).
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "peis/tuples/tuple.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

enum class read_mode : std::uint8_t {
  keep_old,   ///< whatever is there
  filter_old, ///< only what has not been read since it was stored
};

/// A tuple read, or none. Holding it keeps this value; it is not that of later sets.
struct reading {
  tuple_pointer content;   ///< null if there is none
  bool was_new = false;    ///< not read before
  cause why = cause::none; ///< none also if there is simply no such tuple

  explicit operator bool() const { return content != nullptr; }
};

/// D1.1's ResultSet: what one or several tuple_reader::get_all() have found, in order. Its cursor
/// stands before the first until next() is called. Creating is constructing, deleting destroying.
class result_set {
public:
  [[nodiscard]] bool is_empty() const { return found_.empty(); }
  [[nodiscard]] std::size_t size() const { return found_.size(); }

  /// Puts the cursor before the first again.
  void first() { cursor_ = 0; }

  /// Moves the cursor on. @returns false if it has passed the last
  bool next() {
    cursor_ += cursor_ <= found_.size() ? 1 : 0;
    return cursor_ <= found_.size();
  }

  /// The tuple under the cursor; bad_index before the first and after the last.
  [[nodiscard]] reading value() const {
    if (cursor_ == 0 || cursor_ > found_.size())
      return {nullptr, false, cause::bad_index};
    return found_[cursor_ - 1];
  }

  /// Empties it.
  void reset() {
    found_.clear();
    cursor_ = 0;
  }

  /// Adds behind what is there; the cursor stays.
  void append(reading x) { found_.push_back(std::move(x)); }

private:
  std::vector<reading> found_;
  std::size_t cursor_ = 0; ///< one more than the index it stands on
};

} // namespace rubicon::peis
