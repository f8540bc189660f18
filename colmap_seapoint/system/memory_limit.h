// How much memory there is, and sizes as people type and read them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace colmap_seapoint {

// What this process may use at most: the machine's memory, the limit of its control group and of
// those above it (containers; version 1 and 2), `ulimit -v`; the smallest of them, in bytes. `root`
// stands for / where a test plays a system.
uint64_t AvailableMemoryBytes(const std::filesystem::path& root = "/");

// "4G", "500M", "2048K" (powers of 1024; small letters, and a B or iB behind them, are fine) or
// plain bytes; nullopt for what is no such size, is zero, or does not fit.
std::optional<uint64_t> ParseBytes(const std::string& text);

// "3.2 GB", "640 MB": powers of 1024, as ParseBytes reads them.
std::string BytesText(uint64_t bytes);

}  // namespace colmap_seapoint
