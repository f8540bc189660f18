#include "colmap_seapoint/frames/extract_frames.h"

#include <cmath>
#include <cstdio>
#include <ctime>
#include <optional>
#include <system_error>

#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/frames/frame_chooser.h"
#include "colmap_seapoint/io/image/jpeg_exif.h"

namespace colmap_seapoint {
namespace {

std::string FrameName(const std::string& prefix, int64_t index) {
  char number[32];
  std::snprintf(number, sizeof(number), "_%06lld.jpg", static_cast<long long>(index));
  return prefix + number;
}

std::optional<int64_t> TimeOf(const VideoInfo& info, double seconds) {
  if (!info.start_time_us) return std::nullopt;
  return *info.start_time_us + std::llround(seconds * 1e6);
}

std::string IsoText(const std::optional<int64_t>& time_us) {
  if (!time_us) return {};
  const std::time_t seconds = *time_us / 1000000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char date[32], text[48];
  std::strftime(date, sizeof(date), "%Y-%m-%dT%H:%M:%S", &parts);
  std::snprintf(text, sizeof(text), "%s.%03d", date, static_cast<int>(*time_us % 1000000 / 1000));
  return text;
}

ExtractedFrame Describe(const ChosenFrame& chosen, const VideoInfo& info,
                        const std::string& prefix) {
  return {FrameName(prefix, chosen.frame.index), chosen.frame.seconds, chosen.overlap,
          chosen.sharpness, IsoText(TimeOf(info, chosen.frame.seconds))};
}

}  // namespace

ExtractedClip ExtractFrames(VideoFile* video, const std::string& label,
                            const std::filesystem::path& images, const std::string& prefix,
                            const FrameSelectionOptions& options,
                            const std::function<void(const std::string&)>& begin) {
  const VideoInfo& info = video->Info();
  ExtractedClip extracted;
  FrameChooser chooser(options, [&](const ChosenFrame& chosen) {
    extracted.frames.push_back(Describe(chosen, info, prefix));
    const std::string& name = extracted.frames.back().name;
    begin(name);
    std::error_code error;  // whose result WriteJpeg says
    std::filesystem::create_directories((images / name).parent_path(), error);
    WriteJpeg(images / name, chosen.frame.Color(),
              MakeExif(TimeOf(info, chosen.frame.seconds), info.maker, info.model));
  });
  const auto total = static_cast<int64_t>(std::llround(info.duration_seconds));
  Progress progress("Frames of " + label + ", seconds", total, 0, Work::kIntake);
  while (const auto frame = video->Next()) {
    chooser.Add(*frame);
    ++extracted.num_frames;
    extracted.seconds = frame->seconds;
    extracted.is_interlaced |= frame->IsInterlaced();
    progress.Update(std::min(total, static_cast<int64_t>(frame->seconds)));
  }
  chooser.Finish();
  progress.Finish();
  extracted.shortfall = video->Shortfall();
  return extracted;
}

}  // namespace colmap_seapoint
