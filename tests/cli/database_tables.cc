#include "tests/cli/database_tables.h"

#include <sqlite3.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

namespace colmap_seapoint {
namespace {

constexpr size_t kShownLetters = 120;

class Connection {
 public:
  explicit Connection(const std::filesystem::path& path) {
    if (sqlite3_open_v2(path.c_str(), &db_, SQLITE_OPEN_READWRITE, nullptr) != SQLITE_OK) Fail();
  }
  ~Connection() { sqlite3_close_v2(db_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void Execute(const std::string& sql) {
    if (sqlite3_exec(db_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) Fail();
  }

  TableRows Query(const std::string& sql) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(db_, sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) Fail();
    TableRows rows;
    while (sqlite3_step(statement) == SQLITE_ROW) {
      std::string row;
      for (int i = 0; i < sqlite3_column_count(statement); ++i) {
        row += (i > 0 ? "|" : "") + ValueText(statement, i);
      }
      rows.push_back(row);
    }
    if (sqlite3_finalize(statement) != SQLITE_OK) Fail();
    return rows;
  }

 private:
  [[noreturn]] void Fail() const { throw std::runtime_error(sqlite3_errmsg(db_)); }

  static std::string ValueText(sqlite3_stmt* statement, int i) {
    const int type = sqlite3_column_type(statement, i);
    if (type == SQLITE_NULL) return "NULL";
    const auto* bytes = static_cast<const unsigned char*>(sqlite3_column_blob(statement, i));
    const auto size = static_cast<size_t>(sqlite3_column_bytes(statement, i));
    if (type != SQLITE_BLOB) {
      return std::string(type == SQLITE_TEXT ? "'" : "") +
             std::string(reinterpret_cast<const char*>(bytes), size);
    }
    static constexpr char kDigits[] = "0123456789abcdef";
    std::string hex = "x";
    for (size_t k = 0; k < size; ++k) {
      hex += {kDigits[bytes[k] / 16], kDigits[bytes[k] % 16]};
    }
    return hex;
  }

  sqlite3* db_ = nullptr;
};

}  // namespace

TableRows QueryRows(const std::filesystem::path& path, const std::string& sql) {
  return Connection(path).Query(sql);
}

void ExecuteSql(const std::filesystem::path& path, const std::string& sql) {
  Connection(path).Execute(sql);
}

std::map<std::string, TableRows> ReadTables(const std::filesystem::path& path) {
  Connection connection(path);
  std::map<std::string, TableRows> tables;
  for (const std::string& quoted :
       connection.Query("SELECT name FROM sqlite_master WHERE type = 'table' AND "
                        "name NOT LIKE 'sqlite\\_%' ESCAPE '\\'")) {
    const std::string name = quoted.substr(1);
    tables[name] = connection.Query("SELECT * FROM " + name);
    std::sort(tables[name].begin(), tables[name].end());
  }
  return tables;
}

std::vector<std::string> LostRows(const std::map<std::string, TableRows>& before,
                                  const std::map<std::string, TableRows>& after) {
  std::vector<std::string> lost;
  for (const auto& [table, rows] : before) {
    const auto now = after.find(table);
    TableRows missing = rows;
    if (now != after.end()) {
      missing.clear();
      std::set_difference(rows.begin(), rows.end(), now->second.begin(), now->second.end(),
                          std::back_inserter(missing));
    }
    for (const std::string& row : missing) {
      lost.push_back(table + ": " + row.substr(0, kShownLetters));
    }
  }
  return lost;
}

std::vector<std::string> Unsound(const std::filesystem::path& path) {
  std::vector<std::string> complaints = QueryRows(path, "PRAGMA integrity_check");
  if (complaints == std::vector<std::string>{"'ok"}) complaints.clear();
  for (const std::string& row : QueryRows(path, "PRAGMA foreign_key_check")) {
    complaints.push_back(row);
  }
  return complaints;
}

}  // namespace colmap_seapoint
