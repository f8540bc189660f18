#include "examples/benchmarks/densify/measure_program.h"

#include <sys/resource.h>
#include <unistd.h>

#include <functional>
#include <opencv2/imgcodecs.hpp>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/subprocess.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "examples/benchmarks/densify/cpu_seconds.h"
#include "examples/benchmarks/feature/pair_measures.h"

namespace colmap_seapoint {
namespace {

rusage ChildrenUsage() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return usage;
}

double CpuSeconds(const rusage& usage) {
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

struct TemporaryFolder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("densify_benchmark_" + std::to_string(getpid()));
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

void RunProgram(const ProgramOptions& options, ProgramRow* row) {
  const TemporaryFolder output;
  std::vector<std::string> arguments = {
      "partial_densifier",         "--image_path",  options.image_path.string(), "--input_path",
      options.input_path.string(), "--output_path", output.path.string()};
  if (!options.database_path.empty()) {
    arguments.insert(arguments.end(), {"--database_path", options.database_path});
  }
  arguments.insert(arguments.end(), options.arguments.begin(), options.arguments.end());
  std::vector<double> cpu, wall;
  for (int repeat = 0; repeat < options.num_repeats; ++repeat) {
    std::string last_line;
    const rusage before = ChildrenUsage();
    const Timer timer;
    const SubprocessResult result = RunSubprocess(
        options.binary, arguments, "", [&](const std::string& line) { last_line = line; });
    if (!result.Succeeded()) {
      throw Error(options.binary.string(), result.Text() + ": " + last_line, "run it by hand");
    }
    wall.push_back(timer.WallSeconds());
    cpu.push_back(CpuSeconds(ChildrenUsage()) - CpuSeconds(before));
  }
  row->cpu = Median(cpu);
  row->wall = Median(wall);
  row->peak_rss_mb = static_cast<double>(ChildrenUsage().ru_maxrss) / 1e3;
}

double MedianCpu(int num_repeats, const std::function<void()>& work) {
  std::vector<double> seconds;
  for (int repeat = 0; repeat < num_repeats; ++repeat) seconds.push_back(CpuSecondsOf(work));
  return Median(seconds);
}

}  // namespace

ProgramRow MeasureProgram(const ProgramOptions& options) {
  ProgramRow row;
  row.set = options.set_name;
  for (const std::string& argument : options.arguments) {
    row.arguments += (row.arguments.empty() ? "" : " ") + argument;
  }
  row.threads = EffectiveNumThreads(-1);
  RunProgram(options, &row);
  const SparseModel model = ReadSparseModel(options.input_path);
  double pixels = 0;
  row.decode_cpu = MedianCpu(options.num_repeats, [&] {
    pixels = 0;
    for (const PosedImage& image : model.images) {
      const cv::Mat picture =
          cv::imread((options.image_path / image.name).string(), cv::IMREAD_COLOR);
      if (picture.empty()) {
        throw Error((options.image_path / image.name).string(), "cannot be decoded",
                    "check the pictures");
      }
      pixels += static_cast<double>(picture.total());
    }
  });
  row.own_decode_cpu = MedianCpu(options.num_repeats, [&] {
    for (const PosedImage& image : model.images) ReadPicture(options.image_path / image.name);
  });
  row.pictures = static_cast<double>(model.images.size());
  row.megapixels = 1e-6 * pixels;
  return row;
}

}  // namespace colmap_seapoint
