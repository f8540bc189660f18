#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "colmap_seapoint/io/video/video_decoder.h"

namespace colmap_seapoint {
namespace {

// Cameras whose clock was never set write 1904 or 1970: that is no time of a recording.
constexpr int64_t kEarliestStart = 946684800000000;  // 2000-01-01

std::string Tag(const AVDictionary* tags, const char* name) {
  const AVDictionaryEntry* entry = av_dict_get(tags, name, nullptr, 0);
  return entry == nullptr ? "" : entry->value;
}

// Of the first name that there is.
std::string Tag(const AVFormatContext& format, const AVStream& stream,
                std::initializer_list<const char*> names) {
  for (const char* name : names) {
    for (const AVDictionary* tags : {format.metadata, stream.metadata}) {
      std::string value = Tag(tags, name);
      if (!value.empty()) return value;
    }
  }
  return {};
}

int QuarterTurns(const AVStream& stream) {
  const auto* matrix = reinterpret_cast<const int32_t*>(
      av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr));
  if (matrix == nullptr) return 0;
  // libav's angle turns the other way round.
  const double angle_deg = -av_display_rotation_get(matrix);
  if (!std::isfinite(angle_deg)) return 0;
  return (static_cast<int>(std::lround(angle_deg / 90)) % 4 + 4) % 4;
}

}  // namespace

VideoInfo ReadVideoInfo(const AVFormatContext& format, const AVStream& stream) {
  VideoInfo info;
  const AVCodecParameters& codec = *stream.codecpar;
  const AVRational aspect = av_guess_sample_aspect_ratio(const_cast<AVFormatContext*>(&format),
                                                         const_cast<AVStream*>(&stream), nullptr);
  // Beyond this it is a damaged header, not a format.
  const double pixel_aspect = aspect.num > 0 && aspect.den > 0 ? av_q2d(aspect) : 1;
  info.pixel_aspect = pixel_aspect > 0.25 && pixel_aspect < 4 ? pixel_aspect : 1;
  info.quarter_turns = QuarterTurns(stream);
  info.width = std::max(1, static_cast<int>(std::lround(codec.width * info.pixel_aspect)));
  info.height = codec.height;
  if (info.quarter_turns % 2 == 1) std::swap(info.width, info.height);
  if (stream.duration > 0) {
    info.duration_seconds = static_cast<double>(stream.duration) * av_q2d(stream.time_base);
  } else if (format.duration > 0) {
    info.duration_seconds = static_cast<double>(format.duration) / AV_TIME_BASE;
  }
  const AVRational rate = stream.avg_frame_rate;
  if (rate.num > 0 && rate.den > 0) info.frame_seconds = 1 / av_q2d(rate);
  int64_t start_us = 0;
  const std::string start =
      Tag(format, stream, {"creation_time", "com.apple.quicktime.creationdate"});
  if (!start.empty() && av_parse_time(&start_us, start.c_str(), 0) == 0 &&
      start_us >= kEarliestStart) {
    info.start_time_us = start_us;
  }
  info.maker =
      Tag(format, stream, {"com.apple.quicktime.make", "com.android.manufacturer", "make"});
  info.model = Tag(format, stream, {"com.apple.quicktime.model", "com.android.model", "model"});
  return info;
}

}  // namespace colmap_seapoint
