// A look into a database past our own code: every row of every table.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace colmap_seapoint {

// One text a row: its columns joined by '|', each with its type, blobs in hex.
using TableRows = std::vector<std::string>;

// Every table but SQLite's own, ours included: name -> rows, sorted.
std::map<std::string, TableRows> ReadTables(const std::filesystem::path& path);

// Rows of a query, as above. Throws std::runtime_error with SQLite's message.
TableRows QueryRows(const std::filesystem::path& path, const std::string& sql);
void ExecuteSql(const std::filesystem::path& path, const std::string& sql);

// What of `before` is not in `after`, "table: row" each, rows cut to some letters; empty when every
// row is still there, byte by byte.
std::vector<std::string> LostRows(const std::map<std::string, TableRows>& before,
                                  const std::map<std::string, TableRows>& after);

// What PRAGMA integrity_check and foreign_key_check complain of; empty: nothing.
std::vector<std::string> Unsound(const std::filesystem::path& path);

}  // namespace colmap_seapoint
