#include "colmap_seapoint/system/memory_limit.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class FakeSystem : public testing::Test {
 protected:
  FakeSystem() {
    std::string path = (fs::temp_directory_path() / "seapoint_system_XXXXXX").string();
    root_ = mkdtemp(path.data());
  }
  ~FakeSystem() override { fs::remove_all(root_); }

  void Write(const std::string& path, const std::string& text) const {
    fs::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text << "\n";
  }

  fs::path root_;
};

TEST_F(FakeSystem, NoGroupIsTheWholeMachine) {
  const auto machine =
      static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
  EXPECT_EQ(AvailableMemoryBytes(root_), machine);
  Write("proc/self/cgroup", "0::/");
  Write("sys/fs/cgroup/memory.max", "max");
  EXPECT_EQ(AvailableMemoryBytes(root_), machine);
  EXPECT_LE(AvailableMemoryBytes(), machine);
}

TEST_F(FakeSystem, TheTightestGroupCounts) {
  Write("proc/self/cgroup", "0::/user.slice/job");
  Write("sys/fs/cgroup/user.slice/memory.max", "50000000");
  Write("sys/fs/cgroup/user.slice/job/memory.max", "max");
  EXPECT_EQ(AvailableMemoryBytes(root_), 50000000u);
  Write("sys/fs/cgroup/user.slice/job/memory.max", "40000000");
  EXPECT_EQ(AvailableMemoryBytes(root_), 40000000u);
  // A container sees its own group as the root.
  Write("sys/fs/cgroup/memory.max", "30000000");
  EXPECT_EQ(AvailableMemoryBytes(root_), 30000000u);
}

TEST_F(FakeSystem, Version1) {
  Write("proc/self/cgroup", "5:cpu,cpuacct:/job\n4:memory:/job\n1:name=systemd:/");
  Write("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "60000000");
  Write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712");
  EXPECT_EQ(AvailableMemoryBytes(root_), 60000000u);
}

// For a child: it cannot be undone.
[[noreturn]] void LookWithin(uint64_t address_bytes, const fs::path& root) {
  const rlimit limit = {address_bytes, address_bytes};
  setrlimit(RLIMIT_AS, &limit);
  _exit(AvailableMemoryBytes(root) == address_bytes ? 42 : 1);
}

TEST_F(FakeSystem, AddressSpace) {
  EXPECT_EXIT(LookWithin(300 << 20, root_), testing::ExitedWithCode(42), "");
}

TEST(ParseBytes, Table) {
  EXPECT_EQ(ParseBytes("4G"), 4ull << 30);
  EXPECT_EQ(ParseBytes("4GB"), 4ull << 30);
  EXPECT_EQ(ParseBytes("4GiB"), 4ull << 30);
  EXPECT_EQ(ParseBytes("1.5g"), 3ull << 29);
  EXPECT_EQ(ParseBytes("500M"), 500ull << 20);
  EXPECT_EQ(ParseBytes("2k"), 2048u);
  EXPECT_EQ(ParseBytes("1T"), 1ull << 40);
  EXPECT_EQ(ParseBytes("123456"), 123456u);
  EXPECT_EQ(ParseBytes("123456B"), 123456u);
  for (const char* wrong :
       {"", "0", "0.1", "-4G", "G", "4X", "4GX", "4 G", "inf", "nan", "1e9", "99999999999G"}) {
    EXPECT_EQ(ParseBytes(wrong), std::nullopt) << wrong;
  }
}

TEST(BytesText, Table) {
  EXPECT_EQ(BytesText(1), "1 MB");
  EXPECT_EQ(BytesText(640ull << 20), "640 MB");
  EXPECT_EQ(BytesText(3435973837ull), "3.2 GB");
}

}  // namespace
}  // namespace colmap_seapoint
