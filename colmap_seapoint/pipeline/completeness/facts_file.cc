#include "colmap_seapoint/pipeline/completeness/facts_file.h"

#include <cstdint>
#include <cstring>
#include <iterator>
#include <type_traits>
#include <utility>
#include <vector>

#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

const std::string kKind = std::string("seapoint picture facts ") + kPictureFactsVersion;

class Writer {
 public:
  template <typename T>
  void operator()(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  template <typename Range>
  void All(const Range& values) {
    (*this)(uint64_t{values.size()});
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size());
  }
  const std::string& Bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// Of bytes whose hash is right: what is missing at their end reads as nothing.
class Reader {
 public:
  Reader(const char* begin, const char* end) : at_(begin), end_(end) {}

  bool AtEnd() const { return at_ == end_; }
  template <typename T>
  void operator()(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (static_cast<size_t>(end_ - at_) < sizeof(T)) {
      at_ = end_;
      return;
    }
    std::memcpy(&value, at_, sizeof(T));
    at_ += sizeof(T);
  }
  template <typename Range>
  void All(Range& values) {
    uint64_t count = 0;
    (*this)(count);
    const auto left = static_cast<uint64_t>(end_ - at_);
    const char* const stop = at_ + (count < left ? count : left);
    values.assign(at_, stop);
    at_ = stop;
  }

 private:
  const char* at_;
  const char* end_;
};

// Both ways.
template <typename Name, typename Picture, typename Visitor>
void Visit(Name& name, Picture& picture, Visitor& visit) {
  visit.All(name);
  visit.All(picture.content);
  visit(picture.facts.width);
  visit(picture.facts.height);
  visit.All(picture.facts.texture);
  visit.All(picture.facts.flags);
  visit(picture.facts.sharpness);
  visit(picture.brightness);
}

}  // namespace

void WriteMeasuredPictures(const std::filesystem::path& path, const MeasuredPictures& pictures) {
  Writer writer;
  for (const auto& [name, picture] : pictures) Visit(name, picture, writer);
  AtomicFile file(path);
  file.Write(kKind + "\n" + HashText(writer.Bytes()) + "\n");
  file.Write(writer.Bytes());
  file.Commit();
}

MeasuredPictures ReadMeasuredPictures(const std::filesystem::path& path) {
  MeasuredPictures pictures;
  const auto in = OpenIfThere(path);
  if (in == nullptr) return pictures;
  std::string kind, hash;
  if (!std::getline(*in, kind) || kind != kKind || !std::getline(*in, hash)) return pictures;
  const std::string bytes{std::istreambuf_iterator<char>(*in), {}};
  if (HashText(bytes) != hash) return pictures;
  Reader reader(bytes.data(), bytes.data() + bytes.size());
  while (!reader.AtEnd()) {
    std::string name;
    MeasuredPicture picture;
    Visit(name, picture, reader);
    pictures[name] = std::move(picture);
  }
  return pictures;
}

}  // namespace colmap_seapoint
