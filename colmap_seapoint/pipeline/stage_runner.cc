#include "colmap_seapoint/pipeline/stage_runner.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <system_error>
#include <thread>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kFingerprint[] = "fingerprint";
constexpr char kOutputs[] = "outputs";

// More than all rounds of the mapper together leave.
constexpr size_t kMaxModels = 1000;

// A killed run's programs need a moment to end.
constexpr int kLockAttempts = 20;
constexpr std::chrono::milliseconds kLockPause{100};

bool TakeLock(int lock) {
  for (int attempt = 0; attempt < kLockAttempts; ++attempt) {
    if (flock(lock, LOCK_EX | LOCK_NB) == 0) return true;
    if (errno != EWOULDBLOCK && errno != EINTR) return true;  // a file system without locks
    std::this_thread::sleep_for(kLockPause);
  }
  return false;
}

}  // namespace

WorkspaceState::WorkspaceState(const std::filesystem::path& workspace)
    : workspace_(std::filesystem::absolute(workspace).lexically_normal()),
      folder_(workspace_ / "state") {
  CheckWritableDir(workspace_);
  CheckWritableDir(folder_);
  const std::string lock_path = (folder_ / "lock").string();
  lock_ = open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0) {
    throw Error(lock_path, std::string("cannot be opened (") + std::strerror(errno) + ")",
                "choose a --workspace_path that you may write to");
  }
  if (TakeLock(lock_)) return;
  close(lock_);
  throw Error(workspace.string(), "another run is at work in this workspace",
              "wait for it to end, or choose another --workspace_path");
}

WorkspaceState::~WorkspaceState() { close(lock_); }

std::filesystem::path WorkspaceState::PathOf(const std::string& stage) const {
  return folder_ / (stage + ".json");
}

std::optional<Json> WorkspaceState::Read(const std::string& stage) const {
  std::ifstream file(PathOf(stage));
  if (!file) return std::nullopt;
  Json record = Json::parse(file, nullptr, false);
  if (!record.is_object()) return std::nullopt;
  return record;
}

void WorkspaceState::Write(const std::string& stage, const Json& record) {
  syncfs(lock_);
  WriteTextFile(PathOf(stage), record.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void WorkspaceState::Forget(const std::string& stage) {
  const std::filesystem::path path = PathOf(stage);
  std::error_code error;
  std::filesystem::remove(path, error);
  if (error) {
    throw Error(path.string(), "cannot be removed (" + error.message() + ")",
                "choose a --workspace_path that you may write to");
  }
}

std::string StageFingerprint(const Stage& stage) {
  return HashText(stage.version + "\n" + stage.inputs);
}

std::optional<Json> ReadIfDone(const WorkspaceState& state, const Stage& stage) {
  auto record = state.Read(stage.name);
  if (!record || record->value(kFingerprint, Json()) != StageFingerprint(stage))
    return std::nullopt;
  for (const Json& output : record->value(kOutputs, Json::array())) {
    std::error_code error;
    if (!output.is_string()) return std::nullopt;
    if (!std::filesystem::exists(state.Workspace() / output.get<std::string>(), error))
      return std::nullopt;
  }
  if (!stage.done.empty()) LogInfo(stage.done);
  return record;
}

void FinishStage(const Stage& stage, const Json& result,
                 const std::vector<std::filesystem::path>& outputs, WorkspaceState* state) {
  Json record;
  record[kFingerprint] = StageFingerprint(stage);
  record[kOutputs] = Json::array();
  for (const std::filesystem::path& output : outputs) {
    record[kOutputs].push_back(output.lexically_relative(state->Workspace()).string());
  }
  record["result"] = result;
  state->Write(stage.name, record);
}

void RemoveStaleStages(const std::string& prefix, size_t first, const std::filesystem::path& folder,
                       WorkspaceState* state) {
  std::error_code ignored;
  for (size_t k = first; k < first + kMaxModels; ++k) {
    if (!state->Read(prefix + std::to_string(k))) continue;  // failed, between two that did not
    state->Forget(prefix + std::to_string(k));
    std::filesystem::remove_all(folder / std::to_string(k), ignored);
  }
}

}  // namespace colmap_seapoint
