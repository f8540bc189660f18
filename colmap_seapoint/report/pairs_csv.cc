#include "colmap_seapoint/report/pairs_csv.h"

#include <locale>
#include <sstream>
#include <string>

#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

constexpr char kHeader[] =
    "image1,image2,pass,baseline,overlap,num_oa,num_na,num_rea,num_seeds,num_failed_seeds,"
    "num_points,rectification_seconds,propagation_seconds,total_seconds,skipped\n";

// Text that holds what would end a field stands in quotes.
std::string Field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::string NameOf(int image_idx, const SparseModel& model) {
  return image_idx < 0 ? "" : Field(model.images.at(static_cast<size_t>(image_idx)).name);
}

}  // namespace

void WritePairsCsv(const std::filesystem::path& path, const SparseModel& model,
                   const SequenceReport& report, const std::string& earlier_rows) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << kHeader << earlier_rows;
  for (const PairReport& pair : report.pairs) {
    out << NameOf(pair.image_idx1, model) << ',' << NameOf(pair.image_idx2, model) << ','
        << pair.pass << ',' << pair.baseline << ',' << pair.overlap << ',' << pair.num_oa << ','
        << pair.num_na << ',' << pair.num_rea << ',' << pair.num_seeds << ','
        << pair.num_failed_seeds << ',' << pair.num_points << ',' << pair.rectification_seconds
        << ',' << pair.propagation_seconds << ',' << pair.total_seconds << ','
        << Field(pair.skipped) << '\n';
  }
  WriteTextFile(path, out.str());
}

std::string RowsOfPairsCsv(const std::filesystem::path& path) {
  InputStream file(path);
  std::string header;
  std::getline(file, header);
  std::ostringstream rows;
  if (file.peek() != std::istream::traits_type::eof()) rows << file.rdbuf();
  return rows.str();
}

}  // namespace colmap_seapoint
