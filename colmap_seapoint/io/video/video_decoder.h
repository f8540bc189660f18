// libav's objects, owned. For video_*.cc only.
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
#include <libavutil/frame.h>
#include <libavutil/parseutils.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <memory>

#include "colmap_seapoint/io/video/video_file.h"

namespace colmap_seapoint {

struct AvDeleter {
  void operator()(AVFormatContext* format) const { avformat_close_input(&format); }
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};
template <typename T>
using AvPointer = std::unique_ptr<T, AvDeleter>;

struct VideoFile::Decoder {
  AvPointer<AVFormatContext> format;
  AVStream* stream = nullptr;  // of `format`
  AvPointer<AVCodecContext> codec;
  AvPointer<AVPacket> packet;
  bool waits_for_key = false;          // after damage
  int64_t gap_stamp = AV_NOPTS_VALUE;  // of the first packet that was damaged, and not yet passed

  // Gives the codec the next packet of the stream, or the end. False: it was damaged.
  bool Feed();
  // Whether the frame can be trusted: frames come some packets after theirs was fed, in order.
  bool IsSound(const AVFrame& frame);
};

// What the container tells of the stream.
VideoInfo ReadVideoInfo(const AVFormatContext& format, const AVStream& stream);

// The frame at a size (before it is turned), grey or red green blue, then turned.
Image<uint8_t> ConvertFrame(const AVFrame& frame, int width, int height, int num_channels,
                            int quarter_turns);

}  // namespace colmap_seapoint
