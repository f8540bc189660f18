#include "tests/synthetic/video_writer.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
}

#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace colmap_seapoint {
namespace {

constexpr int kTicks = 30000;  // a second

void Check(bool is_right, const char* what) {
  if (!is_right) throw std::runtime_error(std::string("the test's video: ") + what);
}

// One stream in one container.
class Writer {
 public:
  Writer(const std::filesystem::path& path, AVCodecID id) {
    av_log_set_level(AV_LOG_QUIET);
    Check(avformat_alloc_output_context2(&format_, nullptr, nullptr, path.c_str()) >= 0,
          "no container");
    const AVCodec* encoder = avcodec_find_encoder(id);
    Check(encoder != nullptr, "no encoder");
    codec_ = avcodec_alloc_context3(encoder);
    if ((format_->oformat->flags & AVFMT_GLOBALHEADER) != 0) {
      codec_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    }
    stream_ = avformat_new_stream(format_, nullptr);
    Check(avio_open(&format_->pb, path.c_str(), AVIO_FLAG_WRITE) >= 0, "no file");
  }
  ~Writer() {
    avio_closep(&format_->pb);
    avcodec_free_context(&codec_);
    avformat_free_context(format_);
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  AVCodecContext* Codec() { return codec_; }
  AVStream* Stream() { return stream_; }
  void SetFrameDuration(int64_t ticks) { duration_ = ticks; }

  void Begin(const std::string& creation_time) {
    Check(avcodec_open2(codec_, nullptr, nullptr) >= 0, "the encoder does not open");
    avcodec_parameters_from_context(stream_->codecpar, codec_);
    stream_->time_base = codec_->time_base;
    if (!creation_time.empty()) {
      av_dict_set(&format_->metadata, "creation_time", creation_time.c_str(), 0);
    }
    // The index in front, so that a file that is cut can still be opened.
    AVDictionary* options = nullptr;
    av_dict_set(&options, "movflags", "faststart", 0);
    Check(avformat_write_header(format_, &options) >= 0, "no header");
    av_dict_free(&options);
  }

  // nullptr ends it.
  void Add(const AVFrame* frame) {
    Check(avcodec_send_frame(codec_, frame) >= 0, "a frame is refused");
    AVPacket* packet = av_packet_alloc();
    while (avcodec_receive_packet(codec_, packet) >= 0) {
      if (packet->duration == 0) packet->duration = duration_;
      av_packet_rescale_ts(packet, codec_->time_base, stream_->time_base);
      packet->stream_index = stream_->index;
      Check(av_interleaved_write_frame(format_, packet) >= 0, "a packet is refused");
    }
    av_packet_free(&packet);
    if (frame == nullptr) av_write_trailer(format_);
  }

 private:
  AVFormatContext* format_ = nullptr;
  AVCodecContext* codec_ = nullptr;
  AVStream* stream_ = nullptr;
  int64_t duration_ = 0;
};

void SetUp(const VideoSpec& spec, const GrayImage& image, Writer* writer) {
  AVCodecContext* codec = writer->Codec();
  codec->width = image.width;
  codec->height = image.height;
  codec->time_base = {1, kTicks};
  codec->framerate = av_d2q(1 / spec.seconds_per_frame, kTicks);
  codec->pix_fmt = spec.is_10_bit ? AV_PIX_FMT_YUV420P10 : AV_PIX_FMT_YUV420P;
  codec->flags |= AV_CODEC_FLAG_QSCALE | AV_CODEC_FLAG_BITEXACT;
  if (spec.is_interlaced) codec->flags |= AV_CODEC_FLAG_INTERLACED_DCT;
  codec->global_quality = 2 * FF_QP2LAMBDA;
  codec->gop_size = 12;
  if (spec.rotation_deg == 0) return;
  auto* matrix = reinterpret_cast<int32_t*>(
      av_stream_new_side_data(writer->Stream(), AV_PKT_DATA_DISPLAYMATRIX, 9 * sizeof(int32_t)));
  av_display_rotation_set(matrix, spec.rotation_deg);
}

void Fill(const VideoSpec& spec, const GrayImage& image, AVFrame* frame) {
  av_frame_make_writable(frame);
  for (int y = 0; y < image.height; ++y) {
    uint8_t* row = frame->data[0] + static_cast<std::ptrdiff_t>(y) * frame->linesize[0];
    for (int x = 0; x < image.width; ++x) {
      // Of limited range, as videos are.
      const int luma = 16 + image.At(x, y) * 219 / 255;
      if (spec.is_10_bit) {
        reinterpret_cast<uint16_t*>(row)[x] = static_cast<uint16_t>(luma * 4);
      } else {
        row[x] = static_cast<uint8_t>(luma);
      }
    }
  }
  for (const int plane : {1, 2}) {
    for (int y = 0; y < image.height / 2; ++y) {
      uint8_t* row = frame->data[plane] + static_cast<std::ptrdiff_t>(y) * frame->linesize[plane];
      for (int x = 0; x < image.width / 2; ++x) {
        if (spec.is_10_bit) {
          reinterpret_cast<uint16_t*>(row)[x] = 512;
        } else {
          row[x] = 128;
        }
      }
    }
  }
}

}  // namespace

void WriteVideo(const std::filesystem::path& path, const VideoSpec& spec, int num_frames,
                const std::function<GrayImage(int i)>& draw) {
  Writer writer(path, spec.is_10_bit ? AV_CODEC_ID_FFV1 : AV_CODEC_ID_MPEG4);
  SetUp(spec, draw(0), &writer);
  writer.SetFrameDuration(std::llround(spec.seconds_per_frame * kTicks));
  writer.Begin(spec.creation_time);
  AVFrame* frame = av_frame_alloc();
  frame->format = writer.Codec()->pix_fmt;
  frame->width = writer.Codec()->width;
  frame->height = writer.Codec()->height;
  frame->interlaced_frame = spec.is_interlaced ? 1 : 0;
  frame->top_field_first = 1;
  frame->quality = writer.Codec()->global_quality;
  Check(av_frame_get_buffer(frame, 0) >= 0, "no memory");
  for (int i = 0; i < num_frames; ++i) {
    Fill(spec, draw(i), frame);
    const double seconds =
        spec.times.empty() ? i * spec.seconds_per_frame : spec.times[static_cast<size_t>(i)];
    frame->pts = std::llround(seconds * kTicks);
    writer.Add(frame);
  }
  writer.Add(nullptr);
  av_frame_free(&frame);
}

void WriteSound(const std::filesystem::path& path) {
  Writer writer(path, AV_CODEC_ID_PCM_S16LE);
  constexpr int kRate = 8000;
  AVCodecContext* codec = writer.Codec();
  codec->sample_rate = kRate;
  codec->sample_fmt = AV_SAMPLE_FMT_S16;
  av_channel_layout_default(&codec->ch_layout, 1);
  codec->time_base = {1, kRate};
  writer.Begin("");
  AVFrame* frame = av_frame_alloc();
  frame->format = codec->sample_fmt;
  frame->nb_samples = kRate;
  frame->sample_rate = kRate;
  av_channel_layout_copy(&frame->ch_layout, &codec->ch_layout);
  Check(av_frame_get_buffer(frame, 0) >= 0, "no memory");
  std::memset(frame->data[0], 0, 2 * kRate);
  frame->pts = 0;
  writer.Add(frame);
  writer.Add(nullptr);
  av_frame_free(&frame);
}

GrayImage MakeSeabed(int width, int height, uint32_t seed) {
  cv::Mat sum(height, width, CV_32F, cv::Scalar(128));
  cv::RNG random(seed);
  for (int spacing = 64; spacing >= 2; spacing /= 2) {
    cv::Mat coarse(height / spacing + 2, width / spacing + 2, CV_32F), fine;
    random.fill(coarse, cv::RNG::NORMAL, 0, 20);
    cv::resize(coarse, fine, {}, spacing, spacing, cv::INTER_CUBIC);
    sum += fine(cv::Rect(0, 0, width, height));
  }
  GrayImage seabed(width, height);
  cv::Mat target(height, width, CV_8U, seabed.data.data());
  sum.convertTo(target, CV_8U);
  return seabed;
}

GrayImage Crop(const GrayImage& seabed, double left, double top, int width, int height, int blur) {
  const cv::Mat from(seabed.height, seabed.width, CV_8U, const_cast<uint8_t*>(seabed.data.data()));
  const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, left, 0, 1, top);
  GrayImage crop(width, height);
  cv::Mat target(height, width, CV_8U, crop.data.data());
  cv::warpAffine(from, target, move, target.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REFLECT);
  if (blur > 1) cv::blur(target, target, {blur, 1});
  return crop;
}

}  // namespace colmap_seapoint
