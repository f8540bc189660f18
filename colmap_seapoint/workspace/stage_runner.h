// A stage of a long run is done once. What it was made from, what came out of it and which files
// hold that, each with its size and hash, stand in WORKSPACE/state/<stage>.json, one small atomic
// file a stage; the database alone is not enough, since COLMAP opens it without synchronisation.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/io/outputs/output_folder.h"

namespace colmap_seapoint {

// The records of one workspace's stages, and what in the workspace is ours.
class WorkspaceState {
 public:
  // Creates the folder and holds its lock until the end of this object (and of any program that
  // a killed run had started). What an earlier version made there is taken for ours
  // (earlier_outputs.h). state/ and `outputs` become ours: names of files and folders directly in
  // the workspace. Throws Error when another run works there, or one of these is somebody else's.
  explicit WorkspaceState(const std::filesystem::path& workspace,
                          std::vector<std::string> outputs = {});
  WorkspaceState(const WorkspaceState&) = delete;
  WorkspaceState& operator=(const WorkspaceState&) = delete;

  // nullopt when the stage was not done, or its file is damaged.
  std::optional<nlohmann::ordered_json> Read(const std::string& stage) const;
  // Everything that the workspace's stages wrote is brought to the disk first.
  void Write(const std::string& stage, const nlohmann::ordered_json& record);
  void Forget(const std::string& stage);

  // Absolute. Outputs are remembered relative to it, so that a workspace can be moved.
  const std::filesystem::path& Workspace() const { return folder_.Path(); }
  // Holds the records. All in it is ours.
  std::filesystem::path StateFolder() const;
  OutputFolder* Folder() { return &folder_; }

 private:
  std::filesystem::path PathOf(const std::string& stage) const;

  OutputFolder folder_;
};

// Names a stage and all that its result depends on.
struct Stage {
  std::string name;     // "mapper", "dense_0": of its file
  std::string version;  // of its algorithm, from that algorithm's header
  std::string inputs;   // text that changes whenever options or inputs do
  std::string done;     // said to the user when it was done already; empty = nothing
};

// What a stage gives: a value that is remembered, and the files or folders that hold the rest. When
// a file of them is gone, or no longer holds what it held, the stage counts as not done.
template <typename Result>
struct StageOutput {
  Result result;
  std::vector<std::filesystem::path> outputs;
};

// A hash of the stage's version and inputs.
std::string StageFingerprint(const Stage& stage);

// The record of a stage that was done from the same inputs by the same version, and whose outputs
// are all there as they were; says which one is not. Records of earlier versions tell no more of
// an output than that it was there. Cost: a read of every output.
std::optional<nlohmann::ordered_json> ReadIfDone(const WorkspaceState& state, const Stage& stage);

// The result of such a stage; nullopt when it has to be done.
template <typename Result>
std::optional<Result> ResultIfDone(const WorkspaceState& state, const Stage& stage) {
  const auto record = ReadIfDone(state, stage);
  if (!record) return std::nullopt;
  try {
    return record->at("result").get<Result>();
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // written by a version that kept something else
  }
}

void FinishStage(const Stage& stage, const nlohmann::ordered_json& result,
                 const std::vector<std::filesystem::path>& outputs, WorkspaceState* state);

// The result of the stage: the one that is remembered, or that of `work`, which is remembered then.
// `work` is called after what was known of the stage is forgotten, so that an interruption never
// leaves a record beside half an output.
template <typename Result>
Result RunStage(WorkspaceState* state, const Stage& stage,
                const std::function<StageOutput<Result>()>& work) {
  if (auto known = ResultIfDone<Result>(*state, stage)) return *std::move(known);
  state->Forget(stage.name);
  StageOutput<Result> output = work();
  FinishStage(stage, output.result, output.outputs, state);
  return std::move(output.result);
}

// Forgets the stages <prefix><k> from `first` on, which an earlier run left that had found more
// models, and removes what of theirs is in the folders <k> below `folder`.
void RemoveStaleStages(const std::string& prefix, size_t first, const std::filesystem::path& folder,
                       WorkspaceState* state);

}  // namespace colmap_seapoint
