#include "colmap_seapoint/pipeline/intake/take_frames.h"

#include <cstdio>
#include <optional>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/frames/extract_frames.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/pipeline/intake/take_in.h"

namespace colmap_seapoint {

// What is remembered of a clip. In the library's own namespace: nlohmann finds these by type.
void to_json(nlohmann::ordered_json& json, const ExtractedFrame& frame) {
  json = {{"name", frame.name},
          {"seconds", frame.seconds},
          {"overlap", frame.overlap},
          {"sharpness", frame.sharpness},
          {"time", frame.time}};
}

void from_json(const nlohmann::ordered_json& json, ExtractedFrame& frame) {
  frame = {json.at("name"), json.at("seconds"), json.at("overlap"), json.at("sharpness"),
           json.at("time")};
}

void to_json(nlohmann::ordered_json& json, const ExtractedClip& clip) {
  json = {{"frames", clip.frames},
          {"num_frames", clip.num_frames},
          {"seconds", clip.seconds},
          {"is_interlaced", clip.is_interlaced},
          {"shortfall", clip.shortfall}};
}

void from_json(const nlohmann::ordered_json& json, ExtractedClip& clip) {
  clip = {json.at("frames").get<std::vector<ExtractedFrame>>(), json.at("num_frames"),
          json.at("seconds"), json.at("is_interlaced"), json.at("shortfall")};
}

namespace {

constexpr char kFramesCsv[] = "frames.csv";

std::string Decimals(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, value);
  return text;
}

std::string Quoted(const std::string& text) {
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

// What a diver should know of the clip.
void Tell(const Clip& clip, const ExtractedClip& extracted) {
  std::string line = clip.name + ": " + std::to_string(extracted.frames.size()) + " of " +
                     std::to_string(extracted.num_frames) + " frames are taken, of " +
                     DurationText(extracted.seconds);
  if (extracted.is_interlaced) line += "; it is interlaced: every second row is used";
  LogInfo(line);
  for (size_t i = 1; i < extracted.frames.size(); ++i) {
    const ExtractedFrame& frame = extracted.frames[i];
    if (frame.overlap > 0) continue;
    LogWarning(clip.name + ": what it shows at " + Decimals(frame.seconds, 1) +
               " s has nothing in common with the frame before, of " +
               Decimals(extracted.frames[i - 1].seconds, 1) + " s");
  }
}

Stage ClipStage(size_t k, const Clip& clip, const FrameSelectionOptions& options) {
  return {"frames_" + std::to_string(k), kFrameSelectionVersion,
          clip.prefix + "\n" + HashSamplesOfFile(clip.path) + "\n" +
              OptionsFingerprint(OptionValues(options)),
          clip.name + ": its frames are there already"};
}

ExtractedClip ExtractClip(const Stage& stage, const Clip& clip,
                          const FrameSelectionOptions& options, VideoFile* video,
                          OutputFolder* folder, WorkspaceState* state) {
  state->Forget(stage.name);
  const auto extracted = ExtractFrames(video, clip.name, folder->Path(), clip.prefix, options,
                                       [&](const std::string& name) { folder->Claim({name}); });
  std::vector<std::filesystem::path> outputs;
  for (const ExtractedFrame& frame : extracted.frames) {
    outputs.push_back(folder->Path() / frame.name);
  }
  FinishStage(stage, extracted, outputs, state);
  return extracted;
}

std::string CsvRow(const Clip& clip, const ExtractedFrame& frame) {
  return Quoted(frame.name) + "," + Quoted(clip.name) + "," + Decimals(frame.seconds, 3) + "," +
         Decimals(frame.overlap, 3) + "," + Decimals(frame.sharpness, 1) + "," + frame.time + "\n";
}

// What keeps the clip from being used in full; empty = nothing does.
std::string ProblemOf(const ExtractedClip& extracted) {
  if (!extracted.frames.empty() || !extracted.shortfall.empty()) return extracted.shortfall;
  return "shows nothing that can be followed from frame to frame";
}

// nullopt, with the reason in the report, for a clip that cannot be read. A frame that cannot be
// written is no fault of the clip's, and ends the run.
std::optional<ExtractedClip> TakeClip(size_t k, const Clip& clip,
                                      const FrameSelectionOptions& options, int num_threads,
                                      OutputFolder* folder, WorkspaceState* state,
                                      RunReport* report) {
  std::optional<Stage> stage;
  std::optional<ExtractedClip> extracted;
  std::optional<VideoFile> video;
  try {
    stage = ClipStage(k, clip, options);
    extracted = ResultIfDone<ExtractedClip>(*state, *stage);
    if (!extracted) video.emplace(clip.path, num_threads);
  } catch (const Error& error) {
    LeaveOut(clip.name, error.Finding(), report);
    return std::nullopt;
  }
  if (video) extracted = ExtractClip(*stage, clip, options, &*video, folder, state);
  Tell(clip, *extracted);
  const std::string problem = ProblemOf(*extracted);
  if (!problem.empty()) {
    LeaveOut(extracted->frames.empty() ? clip.name : "a part of " + clip.name, problem, report);
  }
  return extracted;
}

}  // namespace

std::set<std::string> TakeFrames(const std::vector<Clip>& clips,
                                 const FrameSelectionOptions& options, int num_threads,
                                 OutputFolder* folder, WorkspaceState* state, RunReport* report) {
  std::set<std::string> names = {kFramesCsv};
  std::string csv = "frame,clip,seconds,overlap,sharpness,time\n";
  for (size_t k = 0; k < clips.size(); ++k) {
    const auto extracted = TakeClip(k, clips[k], options, num_threads, folder, state, report);
    if (!extracted) continue;
    for (const ExtractedFrame& frame : extracted->frames) {
      names.insert(frame.name);
      csv += CsvRow(clips[k], frame);
    }
  }
  if (names.size() == 1) {
    throw Error(clips.front().path.string(), report->left_out.back().reason,
                "give a video of a textured scene, as the camera recorded it");
  }
  folder->Claim({kFramesCsv});
  WriteTextFile(folder->Path() / kFramesCsv, csv);
  return names;
}

}  // namespace colmap_seapoint
