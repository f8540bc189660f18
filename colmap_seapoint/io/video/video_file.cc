#include "colmap_seapoint/io/video/video_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <new>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/io/files/input_stream.h"
#include "colmap_seapoint/io/video/video_decoder.h"

namespace colmap_seapoint {
namespace {

constexpr int64_t kMaxPixels = int64_t{1} << 28;  // a header that promises more is damaged
constexpr int kMaxDecodingThreads = 16;           // libav's own limit for frames at once
constexpr char kRemedy[] = "copy it again from the card, or take it out of the folder";

std::string AvErrorText(int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {0};
  av_strerror(code, text, sizeof(text));
  return text;
}

void RefuseNoFile(const std::filesystem::path& path) {
  const InputStream readable(path);
  std::error_code error;
  if (std::filesystem::file_size(path, error) == 0 && !error) {
    throw Error(path.string(), "is empty (zero bytes)", kRemedy);
  }
}

AvPointer<AVFormatContext> OpenContainer(const std::filesystem::path& path) {
  AVFormatContext* opened = nullptr;
  // "file:" keeps a name with a colon from being taken for a protocol.
  const int code =
      avformat_open_input(&opened, ("file:" + path.string()).c_str(), nullptr, nullptr);
  if (code == AVERROR(ENOMEM)) throw std::bad_alloc();
  AvPointer<AVFormatContext> format(opened);
  // What it cannot find out, the decoder may.
  if (format != nullptr) avformat_find_stream_info(format.get(), nullptr);
  if (format != nullptr && format->nb_streams > 0) return format;
  throw Error(path.string(),
              "is no video that can be opened" +
                  (code < 0 ? " (" + AvErrorText(code) + ")" : std::string()) +
                  ": it is something else, or the recording was cut off before its index was "
                  "written",
              "put it back into the camera, which may repair it, or take it out of the folder");
}

AVStream* FindPictures(const std::filesystem::path& path, AVFormatContext* format) {
  const int index = av_find_best_stream(format, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  AVStream* stream = index < 0 ? nullptr : format->streams[index];
  // The cover of a piece of music is a picture, but no video.
  if (stream == nullptr || (stream->disposition & AV_DISPOSITION_ATTACHED_PIC) != 0) {
    throw Error(path.string(), "holds sound, or other data, but no pictures",
                "take it out of the folder");
  }
  for (unsigned i = 0; i < format->nb_streams; ++i) {
    if (static_cast<int>(i) != index) format->streams[i]->discard = AVDISCARD_ALL;
  }
  return stream;
}

AvPointer<AVCodecContext> OpenCodec(const std::filesystem::path& path, const AVStream& stream,
                                    int num_threads) {
  const AVCodec* decoder = avcodec_find_decoder(stream.codecpar->codec_id);
  if (decoder == nullptr) {
    throw Error(path.string(),
                std::string("is in a codec that is not decoded here (") +
                    avcodec_get_name(stream.codecpar->codec_id) + "), or is encrypted",
                "convert it to H.264 in an MP4");
  }
  AvPointer<AVCodecContext> codec(avcodec_alloc_context3(decoder));
  if (codec == nullptr || avcodec_parameters_to_context(codec.get(), stream.codecpar) < 0) {
    throw std::bad_alloc();
  }
  codec->thread_count = std::min(EffectiveNumThreads(num_threads), kMaxDecodingThreads);
  codec->pkt_timebase = stream.time_base;
  codec->max_pixels = kMaxPixels;
  const int code = avcodec_open2(codec.get(), decoder, nullptr);
  if (code < 0) {
    throw Error(
        path.string(),
        "its " + std::string(decoder->name) + " cannot be decoded (" + AvErrorText(code) + ")",
        "convert it to H.264 in an MP4");
  }
  return codec;
}

// Frames that a decoder has patched up are damaged too.
bool IsDamaged(const AVFrame& frame) {
  return frame.decode_error_flags != 0 || (frame.flags & AV_FRAME_FLAG_CORRUPT) != 0;
}

std::string SecondsText(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f s", seconds);
  return text;
}

}  // namespace

bool VideoFile::Decoder::Feed() {
  int code = av_read_frame(format.get(), packet.get());
  while (code >= 0 && packet->stream_index != stream->index) {
    av_packet_unref(packet.get());
    code = av_read_frame(format.get(), packet.get());
  }
  if (code == AVERROR(ENOMEM)) throw std::bad_alloc();
  if (code >= 0 && (packet->flags & AV_PKT_FLAG_CORRUPT) != 0) {
    if (gap_stamp == AV_NOPTS_VALUE) gap_stamp = packet->pts;
    av_packet_unref(packet.get());
    return false;
  }
  // A disk that fails ends the video too: what is missing then is said by Shortfall().
  const int sent = avcodec_send_packet(codec.get(), code < 0 ? nullptr : packet.get());
  av_packet_unref(packet.get());
  if (sent == AVERROR(ENOMEM)) throw std::bad_alloc();
  // The codec's errors come in the order of its frames, whatever the number of threads.
  if (code >= 0 && sent < 0) waits_for_key = true;
  return code < 0 || sent >= 0;
}

bool VideoFile::Decoder::IsSound(const AVFrame& frame) {
  if (gap_stamp != AV_NOPTS_VALUE && frame.best_effort_timestamp >= gap_stamp) {
    waits_for_key = true;
    gap_stamp = AV_NOPTS_VALUE;
  }
  if (IsDamaged(frame)) waits_for_key = true;
  if (frame.key_frame != 0 && !IsDamaged(frame)) waits_for_key = false;
  return !waits_for_key;
}

VideoFile::VideoFile(const std::filesystem::path& path, int num_threads)
    : decoder_(std::make_unique<Decoder>()) {
  av_log_set_level(AV_LOG_QUIET);
  RefuseNoFile(path);
  decoder_->format = OpenContainer(path);
  decoder_->stream = FindPictures(path, decoder_->format.get());
  const AVCodecParameters& stream = *decoder_->stream->codecpar;
  if (stream.width <= 0 || stream.height <= 0) {
    throw Error(path.string(), "no frame of it can be decoded: it is damaged, encrypted or cut off",
                kRemedy);
  }
  decoder_->codec = OpenCodec(path, *decoder_->stream, num_threads);
  decoder_->packet.reset(av_packet_alloc());
  if (decoder_->packet == nullptr) throw std::bad_alloc();
  info_ = std::make_shared<VideoInfo>(ReadVideoInfo(*decoder_->format, *decoder_->stream));
}

VideoFile::~VideoFile() = default;

std::optional<VideoFrame> VideoFile::Next() {
  while (true) {
    const std::shared_ptr<AVFrame> frame(av_frame_alloc(), AvDeleter());
    if (frame == nullptr) throw std::bad_alloc();
    const int code = avcodec_receive_frame(decoder_->codec.get(), frame.get());
    if (code == AVERROR(EAGAIN)) {
      num_damaged_ += decoder_->Feed() ? 0 : 1;
    } else if (code == AVERROR_EOF) {
      return std::nullopt;
    } else if (code == AVERROR(ENOMEM)) {
      throw std::bad_alloc();
    } else if (code < 0) {
      ++num_damaged_;
      decoder_->waits_for_key = true;
    } else if (decoder_->IsSound(*frame)) {
      return Timed(frame);
    } else {
      ++num_damaged_;
    }
  }
}

VideoFrame VideoFile::Timed(std::shared_ptr<const AVFrame> frame) {
  const AVStream& stream = *decoder_->stream;
  const int64_t stamp = frame->best_effort_timestamp;
  VideoFrame result;
  result.index = num_frames_;
  if (num_frames_ == 0) first_stamp_ = stamp;
  if (stamp != AV_NOPTS_VALUE && first_stamp_ != AV_NOPTS_VALUE) {
    result.seconds = static_cast<double>(stamp - first_stamp_) * av_q2d(stream.time_base);
  }
  // Without a time, or with one that runs backwards, it comes one frame after the last one.
  if (num_frames_ > 0 && result.seconds <= last_seconds_) {
    result.seconds = last_seconds_ + info_->frame_seconds;
  }
  result.frame_ = std::move(frame);
  result.info_ = info_;
  last_seconds_ = result.seconds;
  ++num_frames_;
  return result;
}

std::string VideoFile::Shortfall() const {
  const double end = num_frames_ == 0 ? 0 : last_seconds_ + info_->frame_seconds;
  const double missing = info_->duration_seconds - end;
  if (num_frames_ == 0) return "no frame of it can be decoded: it is damaged, encrypted or cut off";
  // Containers round, and tell the longest stream's.
  if (missing > std::max(1.0, 3 * info_->frame_seconds)) {
    return "can be read for " + SecondsText(end) + " of " + SecondsText(info_->duration_seconds) +
           " only: the rest is damaged or cut off";
  }
  if (num_damaged_ == 0) return {};
  return "has " + std::to_string(num_damaged_) + " frames that are damaged: they are passed over";
}

}  // namespace colmap_seapoint
