#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/video/video_decoder.h"

namespace colmap_seapoint {
namespace {

// One field of an interlaced frame: every second row of each plane, from the first.
struct Planes {
  const uint8_t* data[AV_NUM_DATA_POINTERS] = {};
  int stride[AV_NUM_DATA_POINTERS] = {};
  int height = 0;
};

Planes PlanesOf(const AVFrame& frame) {
  Planes planes;
  const int step = frame.interlaced_frame != 0 && frame.height > 1 ? 2 : 1;
  for (int plane = 0; plane < AV_NUM_DATA_POINTERS; ++plane) {
    planes.data[plane] = frame.data[plane];
    // A palette has no rows.
    planes.stride[plane] = frame.linesize[plane] * step;
  }
  planes.height = frame.height / step;
  return planes;
}

AvPointer<SwsContext> MakeScaler(const AVFrame& frame, int frame_height, int width, int height,
                                 int num_channels) {
  const auto from = static_cast<AVPixelFormat>(frame.format);
  const AVPixelFormat to = num_channels == 1 ? AV_PIX_FMT_GRAY8 : AV_PIX_FMT_RGB24;
  const int method = num_channels == 1 ? SWS_AREA : SWS_BICUBIC | SWS_FULL_CHR_H_INT;
  AvPointer<SwsContext> scaler(sws_getContext(frame.width, frame_height, from, width, height, to,
                                              method | SWS_ACCURATE_RND | SWS_BITEXACT, nullptr,
                                              nullptr, nullptr));
  if (scaler == nullptr) throw std::bad_alloc();
  // Where the video does not say, high definition is BT.709 and the rest BT.601.
  const int space = frame.colorspace != AVCOL_SPC_UNSPECIFIED ? static_cast<int>(frame.colorspace)
                    : frame.height >= 720                     ? SWS_CS_ITU709
                                                              : SWS_CS_ITU601;
  const bool is_full_range = frame.color_range == AVCOL_RANGE_JPEG;
  sws_setColorspaceDetails(scaler.get(), sws_getCoefficients(space), is_full_range ? 1 : 0,
                           sws_getCoefficients(SWS_CS_ITU601), 1, 0, 1 << 16, 1 << 16);
  return scaler;
}

Image<uint8_t> Turned(Image<uint8_t> image, int quarter_turns) {
  if (quarter_turns == 0) return image;
  const int w = image.width, h = image.height;
  const bool is_sideways = quarter_turns % 2 == 1;
  Image<uint8_t> turned(is_sideways ? h : w, is_sideways ? w : h, image.channels);
  for (int y = 0; y < turned.height; ++y) {
    for (int x = 0; x < turned.width; ++x) {
      const int from_x = quarter_turns == 1 ? y : quarter_turns == 2 ? w - 1 - x : w - 1 - y;
      const int from_y = quarter_turns == 1 ? h - 1 - x : quarter_turns == 2 ? h - 1 - y : x;
      std::memcpy(&turned.At(x, y), &image.At(from_x, from_y), static_cast<size_t>(image.channels));
    }
  }
  return turned;
}

}  // namespace

Image<uint8_t> ConvertFrame(const AVFrame& frame, int width, int height, int num_channels,
                            int quarter_turns) {
  const Planes planes = PlanesOf(frame);
  const auto scaler = MakeScaler(frame, planes.height, width, height, num_channels);
  // libswscale may write some bytes beyond the end of a row.
  const int row = width * num_channels;
  const int stride = (row + 127) / 64 * 64;
  std::vector<uint8_t> padded(static_cast<size_t>(stride) * static_cast<size_t>(height) + 64);
  uint8_t* target[4] = {padded.data()};
  const int target_stride[4] = {stride};
  sws_scale(scaler.get(), planes.data, planes.stride, 0, planes.height, target, target_stride);
  Image<uint8_t> image(width, height, num_channels);
  for (int y = 0; y < height; ++y) {
    std::memcpy(image.Row(y), padded.data() + static_cast<size_t>(y) * static_cast<size_t>(stride),
                static_cast<size_t>(row));
  }
  return Turned(std::move(image), quarter_turns);
}

bool VideoFrame::IsInterlaced() const { return frame_->interlaced_frame != 0; }

GrayImage VideoFrame::Gray() const {
  const int side = std::max(info_->width, info_->height);
  const int factor = std::max(1, static_cast<int>(std::lround(double(side) / kGraySide)));
  const bool is_sideways = info_->quarter_turns % 2 == 1;
  const int width = is_sideways ? info_->height : info_->width;
  const int height = is_sideways ? info_->width : info_->height;
  return ConvertFrame(*frame_, std::max(1, width / factor), std::max(1, height / factor), 1,
                      info_->quarter_turns);
}

ColorImage VideoFrame::Color() const {
  const bool is_sideways = info_->quarter_turns % 2 == 1;
  return ConvertFrame(*frame_, is_sideways ? info_->height : info_->width,
                      is_sideways ? info_->width : info_->height, 3, info_->quarter_turns);
}

}  // namespace colmap_seapoint
