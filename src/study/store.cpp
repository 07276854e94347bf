#include "study/store.hpp"

#include <cmath>
#include <cstring>
#include <stdexcept>

#include <sqlite3.h>

namespace rubicon::study {

namespace {

constexpr int application_id = 0x52756269; ///< of our databases, in their headers
constexpr int patience_ms = 10'000;        ///< while another process writes

/// With a write-ahead log a run costs no wait for the disk.
constexpr const char* tables = R"(
PRAGMA journal_mode = WAL;
PRAGMA synchronous = NORMAL;
BEGIN IMMEDIATE;
CREATE TABLE IF NOT EXISTS run(
  id INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE, file TEXT NOT NULL, seed INTEGER NOT NULL,
  real_s REAL NOT NULL);
CREATE TABLE IF NOT EXISTS parameter(
  run INTEGER NOT NULL REFERENCES run(id), name TEXT NOT NULL, value TEXT NOT NULL,
  PRIMARY KEY(run, name)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS scalar(
  run INTEGER NOT NULL REFERENCES run(id), name TEXT NOT NULL, value REAL NOT NULL,
  PRIMARY KEY(run, name)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS series(
  run INTEGER NOT NULL REFERENCES run(id), name TEXT NOT NULL, at_s REAL NOT NULL,
  value REAL NOT NULL, PRIMARY KEY(run, name, at_s)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS expectation(
  run INTEGER NOT NULL REFERENCES run(id), expect TEXT NOT NULL, met INTEGER,
  measured TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS violation(
  run INTEGER NOT NULL REFERENCES run(id), at_s REAL NOT NULL, invariant TEXT NOT NULL,
  detail TEXT NOT NULL);
CREATE INDEX IF NOT EXISTS expectation_of_run ON expectation(run);
CREATE INDEX IF NOT EXISTS violation_of_run ON violation(run);
PRAGMA application_id = 0x52756269;
COMMIT;
)";

[[noreturn]] void fail(sqlite3* database) {
  throw std::runtime_error("the database of results: " + std::string(sqlite3_errmsg(database)));
}

void execute(sqlite3* database, const char* sql) {
  if (sqlite3_exec(database, sql, nullptr, nullptr, nullptr) != SQLITE_OK)
    fail(database);
}

/// A statement whose values are bound one after the other.
class statement {
public:
  statement(sqlite3* database, const char* sql) : database_(database) {
    if (sqlite3_prepare_v2(database, sql, -1, &statement_, nullptr) != SQLITE_OK)
      fail(database);
  }
  ~statement() { sqlite3_finalize(statement_); }
  statement(const statement&) = delete;
  statement& operator=(const statement&) = delete;

  statement& bind(const std::string& x) {
    return check(sqlite3_bind_text64(statement_, next_++, x.data(), x.size(), SQLITE_TRANSIENT,
                                     SQLITE_UTF8));
  }
  statement& bind(double x) { return check(sqlite3_bind_double(statement_, next_++, x)); }
  statement& bind(std::int64_t x) { return check(sqlite3_bind_int64(statement_, next_++, x)); }
  statement& bind(const std::optional<bool>& x) {
    return check(x ? sqlite3_bind_int(statement_, next_++, *x ? 1 : 0)
                   : sqlite3_bind_null(statement_, next_++));
  }

  /// Whether there is a row; after the last, values are bound anew.
  bool step() {
    const int found = sqlite3_step(statement_);
    if (found == SQLITE_ROW)
      return true;
    if (found != SQLITE_DONE)
      fail(database_);
    sqlite3_reset(statement_);
    next_ = 1;
    return false;
  }
  void run() {
    while (step()) {
    }
  }

  [[nodiscard]] double number(int column) { return sqlite3_column_double(statement_, column); }
  [[nodiscard]] std::string text(int column) {
    const auto* found = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return found == nullptr
               ? std::string()
               : std::string(found,
                             static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)));
  }
  [[nodiscard]] std::int64_t whole(int column) { return sqlite3_column_int64(statement_, column); }

private:
  statement& check(int status) {
    if (status != SQLITE_OK)
      fail(database_);
    return *this;
  }

  sqlite3* database_;
  sqlite3_stmt* statement_ = nullptr;
  int next_ = 1;
};

/// Undone unless it is committed.
class transaction {
public:
  explicit transaction(sqlite3* database) : database_(database) {
    execute(database, "BEGIN IMMEDIATE");
  }
  ~transaction() {
    if (!is_committed_)
      sqlite3_exec(database_, "ROLLBACK", nullptr, nullptr, nullptr);
  }
  transaction(const transaction&) = delete;
  transaction& operator=(const transaction&) = delete;

  void commit() {
    execute(database_, "COMMIT");
    is_committed_ = true;
  }

private:
  sqlite3* database_;
  bool is_committed_ = false;
};

std::optional<std::int64_t> id_of(sqlite3* database, const std::string& key) {
  statement found(database, "SELECT id FROM run WHERE key = ?");
  found.bind(key);
  return found.step() ? std::optional(found.whole(0)) : std::nullopt;
}

void insert_parameters(sqlite3* database, std::int64_t run, const run_parameters& all) {
  statement insert(database, "INSERT OR IGNORE INTO parameter VALUES(?, ?, ?)");
  for (const auto& [name, value] : all)
    insert.bind(run).bind(name).bind(value).run();
}

void insert_results(sqlite3* database, std::int64_t run, const run_result& x) {
  insert_parameters(database, run, x.parameters);
  statement scalar(database, "INSERT INTO scalar VALUES(?, ?, ?)");
  for (const auto& [name, value] : x.scalars)
    if (std::isfinite(value))
      scalar.bind(run).bind(name).bind(value).run();
  statement series(database, "INSERT OR IGNORE INTO series VALUES(?, ?, ?, ?)");
  for (const auto& each : x.series)
    series.bind(run).bind(each.name).bind(each.at_s).bind(each.value).run();
  statement expectation(database, "INSERT INTO expectation VALUES(?, ?, ?, ?)");
  for (const auto& each : x.expectations)
    expectation.bind(run).bind(each.expect).bind(each.met).bind(each.measured).run();
  statement violation(database, "INSERT INTO violation VALUES(?, ?, ?, ?)");
  for (const auto& each : x.violations)
    violation.bind(run).bind(each.at_s).bind(each.invariant).bind(each.detail).run();
}

/// Whether it is empty, or ours.
bool is_ours(sqlite3* database) {
  statement id(database, "PRAGMA application_id");
  if (id.step() && id.whole(0) == application_id)
    return true;
  statement count(database, "SELECT count(*) FROM sqlite_schema");
  return count.step() && count.whole(0) == 0;
}

} // namespace

void store::closer::operator()(sqlite3* x) const {
  sqlite3_close(x);
}

std::variant<store, std::string> store::open(const std::string& path, access how) {
  sqlite3* opened = nullptr;
  // Also to read: what a killed process has left half done must be undone first.
  const int flags = SQLITE_OPEN_READWRITE | (how == access::read ? 0 : SQLITE_OPEN_CREATE);
  const int status = sqlite3_open_v2(path.c_str(), &opened, flags, nullptr);
  handle database(opened);
  if (status != SQLITE_OK)
    return "cannot be opened: " + std::string(sqlite3_errstr(status));
  sqlite3_busy_timeout(database.get(), patience_ms);
  sqlite3_limit(database.get(), SQLITE_LIMIT_ATTACHED, 0);
  try {
    if (!is_ours(database.get()))
      return "is not a database of a study";
    execute(database.get(), how == access::write ? tables : "PRAGMA query_only = 1");
  } catch (const std::runtime_error&) {
    return "cannot be used: " + std::string(sqlite3_errmsg(database.get()));
  }
  return store(std::move(database));
}

bool store::has(const std::string& key) {
  return id_of(database_.get(), key).has_value();
}

void store::add(const run_result& x) {
  auto* const database = database_.get();
  transaction all(database);
  if (!id_of(database, x.key)) {
    statement(database, "INSERT INTO run(key, file, seed, real_s) VALUES(?, ?, ?, ?)")
        .bind(x.key)
        .bind(x.file)
        .bind(static_cast<std::int64_t>(x.seed))
        .bind(x.real_s)
        .run();
    insert_results(database, sqlite3_last_insert_rowid(database), x);
  }
  all.commit();
}

void store::add_parameters(const std::string& key, const run_parameters& all) {
  const auto run = id_of(database_.get(), key);
  if (!run)
    return;
  transaction changes(database_.get());
  insert_parameters(database_.get(), *run, all);
  changes.commit();
}

std::vector<std::optional<double>> store::values(const std::vector<std::string>& keys,
                                                 const std::string& scalar) {
  statement found(database_.get(), "SELECT value FROM scalar JOIN run ON run.id = scalar.run "
                                   "WHERE run.key = ? AND scalar.name = ?");
  std::vector<std::optional<double>> out;
  for (const auto& key : keys) {
    found.bind(key).bind(scalar);
    out.emplace_back();
    while (found.step())
      out.back() = found.number(0);
  }
  return out;
}

void store::for_each_run(const std::function<void(const run_result&)>& take) {
  auto* const database = database_.get();
  statement runs(database, "SELECT id, seed, key FROM run ORDER BY id");
  statement parameters(database, "SELECT name, value FROM parameter WHERE run = ?");
  statement scalars(database, "SELECT name, value FROM scalar WHERE run = ?");
  while (runs.step()) {
    const auto run = runs.whole(0);
    run_result x;
    x.seed = static_cast<std::uint64_t>(runs.whole(1));
    x.key = runs.text(2);
    parameters.bind(run);
    while (parameters.step())
      x.parameters.emplace_back(parameters.text(0), parameters.text(1));
    scalars.bind(run);
    while (scalars.step())
      x.scalars.emplace(scalars.text(0), scalars.number(1));
    take(x);
  }
}

std::variant<answer, std::string> store::query(const std::string& sql) {
  auto* const database = database_.get();
  sqlite3_stmt* prepared = nullptr;
  const char* rest = nullptr;
  const int status = sqlite3_prepare_v2(database, sql.c_str(), -1, &prepared, &rest);
  const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> owner(prepared, sqlite3_finalize);
  if (status != SQLITE_OK)
    return std::string(sqlite3_errmsg(database));
  if (prepared == nullptr)
    return "there is no statement";
  if (sqlite3_stmt_readonly(prepared) == 0)
    return "it would change the database";
  if (std::strspn(rest, "; \t\r\n") != std::strlen(rest))
    return "there is more than one statement";
  answer out;
  const int columns = sqlite3_column_count(prepared);
  for (int i = 0; i < columns; ++i)
    out.columns.emplace_back(sqlite3_column_name(prepared, i));
  int found = sqlite3_step(prepared);
  for (; found == SQLITE_ROW && out.rows.size() < answer::rows_max;
       found = sqlite3_step(prepared)) {
    auto& row = out.rows.emplace_back();
    for (int i = 0; i < columns; ++i) {
      const auto* text = sqlite3_column_text(prepared, i);
      row.emplace_back(text == nullptr ? "" : reinterpret_cast<const char*>(text),
                       static_cast<std::size_t>(sqlite3_column_bytes(prepared, i)));
    }
  }
  out.has_more = found == SQLITE_ROW;
  if (found != SQLITE_ROW && found != SQLITE_DONE)
    return std::string(sqlite3_errmsg(database));
  return out;
}

} // namespace rubicon::study
