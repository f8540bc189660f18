#include "colmap_seapoint/workspace/stage_runner.h"

#include <unistd.h>

#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/input_stream.h"
#include "colmap_seapoint/io/outputs/file_record.h"
#include "colmap_seapoint/workspace/earlier_outputs.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kFingerprint[] = "fingerprint";
constexpr char kOutputs[] = "outputs";

// More than all rounds of the mapper together leave.
constexpr size_t kMaxModels = 1000;

constexpr char kState[] = "state";

Json ToJson(const FileRecord& record) {
  return {{"path", record.path}, {"size", record.size}, {"hash", record.hash}};
}

// What is wrong with an output, or "". Throws a json exception for what is no record of one.
std::string OutputProblem(const std::filesystem::path& workspace, const Json& output) {
  if (output.is_object()) {
    return RecordProblem(workspace, {output.at("path"), output.at("size"), output.at("hash")});
  }
  // Of an earlier version: the path alone.
  const std::filesystem::path path = workspace / output.get<std::string>();
  std::error_code error;
  return std::filesystem::exists(path, error) ? "" : path.string() + " is gone";
}

bool OutputsAreWhole(const std::filesystem::path& workspace, const Json& outputs) {
  for (const Json& output : outputs) {
    std::string problem;
    try {
      problem = OutputProblem(workspace, output);
    } catch (const Json::exception&) {
      return false;
    }
    if (problem.empty()) continue;
    LogWarning(problem + ": it is made again");
    return false;
  }
  return true;
}

}  // namespace

WorkspaceState::WorkspaceState(const std::filesystem::path& workspace,
                               std::vector<std::string> outputs)
    : folder_(workspace, "--workspace_path", IfBusy::kWaitForChildren) {
  AdoptEarlierWorkspace(&folder_);
  outputs.emplace_back(kState);
  folder_.Claim(outputs);
  CheckWritableDir(StateFolder());
}

std::filesystem::path WorkspaceState::StateFolder() const { return Workspace() / kState; }

std::filesystem::path WorkspaceState::PathOf(const std::string& stage) const {
  return StateFolder() / (stage + ".json");
}

std::optional<Json> WorkspaceState::Read(const std::string& stage) const {
  const auto file = OpenIfThere(PathOf(stage));
  if (!file) return std::nullopt;
  Json record = Json::parse(*file, nullptr, false);
  if (!record.is_object()) return std::nullopt;
  return record;
}

void WorkspaceState::Write(const std::string& stage, const Json& record) {
  syncfs(folder_.Lock().Descriptor());
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
  if (!OutputsAreWhole(state.Workspace(), record->value(kOutputs, Json::array()))) {
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
  for (const FileRecord& file : RecordFiles(state->Workspace(), outputs)) {
    record[kOutputs].push_back(ToJson(file));
  }
  record["result"] = result;
  state->Write(stage.name, record);
}

void RemoveStaleStages(const std::string& prefix, size_t first, const std::filesystem::path& folder,
                       WorkspaceState* state) {
  for (size_t k = first; k < first + kMaxModels; ++k) {
    const std::string number = std::to_string(k);
    if (!state->Read(prefix + number)) continue;  // failed, between two that did not
    state->Forget(prefix + number);
    RemoveOutputs(folder / number);
  }
}

}  // namespace colmap_seapoint
