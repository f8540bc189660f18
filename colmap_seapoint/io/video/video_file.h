// Videos on disk, decoded frame by frame through libav (libavformat, libavcodec, libswscale).
//
// Frames come upright (the display matrix is applied), with square pixels, deinterlaced where they
// are interlaced, in 8 bits whatever the video holds, and with the times that the container gives
// them: a variable frame rate is no special case. libav's own messages are not printed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "colmap_seapoint/base/image.h"

struct AVFrame;

namespace colmap_seapoint {

struct VideoInfo {
  int width = 0;  // pixels of a frame as it comes: upright and square
  int height = 0;
  int quarter_turns = 0;                 // clockwise, that make it upright
  double pixel_aspect = 1;               // width of a stored pixel in its heights
  double duration_seconds = 0;           // as the container promises; 0 = unknown
  double frame_seconds = 1.0 / 30;       // usual time from frame to frame
  std::optional<int64_t> start_time_us;  // of the recording, since 1970, as its clock said
  std::string maker, model;              // of the camera; empty = the container does not tell
};

// One decoded frame. Copies share it; each keeps its memory (1.5 to 3 bytes a pixel) in use. It may
// outlive its file.
class VideoFrame {
 public:
  int64_t index = 0;   // in the order of showing, from 0
  double seconds = 0;  // since the first frame; grows from frame to frame

  bool IsInterlaced() const;
  // The brightness, made smaller by an area mean: the whole-numbered factor that brings the longer
  // side nearest to kGraySide. About 1 ms for a frame of 1080p.
  GrayImage Gray() const;
  // In full. About 10 ms for a frame of 1080p.
  ColorImage Color() const;

  static constexpr int kGraySide = 960;

 private:
  friend class VideoFile;
  std::shared_ptr<const AVFrame> frame_;
  std::shared_ptr<const VideoInfo> info_;
};

class VideoFile {
 public:
  // Throws Error for a file that cannot be read, is no video, has no pictures (sound alone), is cut
  // off so that no player opens it, or has a codec that this libav cannot decode. num_threads (-1:
  // all cores) decode; the frames are the same for any number.
  VideoFile(const std::filesystem::path& path, int num_threads);
  ~VideoFile();
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  const VideoInfo& Info() const { return *info_; }

  // The next frame that is whole; nullopt at the end. After a damaged one, frames are passed over
  // until the next one that can be decoded by itself.
  std::optional<VideoFrame> Next();

  // What was missing, as words for the user, once Next() has given nullopt: damaged frames that
  // were passed over, or an end before the promised one. "" when all was there.
  std::string Shortfall() const;

 private:
  struct Decoder;

  VideoFrame Timed(std::shared_ptr<const AVFrame> frame);

  std::unique_ptr<Decoder> decoder_;
  std::shared_ptr<const VideoInfo> info_;
  int64_t num_frames_ = 0, num_damaged_ = 0;
  int64_t first_stamp_ = 0;  // of the first frame, in the stream's units
  double last_seconds_ = 0;
};

}  // namespace colmap_seapoint
